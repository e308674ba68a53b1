"""Comparison of speed with other libraries: `python -m experiments.speed.peers`.

`make benchmark-peers` runs it in a virtual environment of its own. The module `libraries` imports the
libraries, and only `__main__` imports it; so everything else can be tested without.

mealpy is left out: it needs a NumPy below 1.27, which swarm_gym does not support.
"""

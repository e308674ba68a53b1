"""Comparison of speed with other libraries: `python -m experiments.speed.peers`.

`make benchmark-peers` runs it in a virtual environment of its own. Each library has one module, which only
`__main__` imports; so everything else can be tested without the libraries.

mealpy is left out: it needs a NumPy below 1.27, which swarm_gym does not support.
"""

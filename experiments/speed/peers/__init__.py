"""swarm_gym beside other libraries, in one run: `python -m experiments.speed.peers`.

`make benchmark-peers` runs it in an environment of its own. There is one module per library; `__main__` alone
imports these, so that what is measured can be tested where none is installed.

Left out: mealpy, which asks for a NumPy below 1.27, older than what swarm_gym runs with.
"""

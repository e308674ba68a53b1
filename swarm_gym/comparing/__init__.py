"""Comparison of controllers on the same scenarios and seeds; `swarm-gym compare` prints a table."""

from swarm_gym.comparing.compared_runs import ComparedRuns
from swarm_gym.comparing.comparison import compare

__all__ = ["ComparedRuns", "compare"]

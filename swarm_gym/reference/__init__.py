"""The true optimum of a problem, where it can be computed."""

from swarm_gym.reference.optima import known_optimum

__all__ = ["known_optimum"]

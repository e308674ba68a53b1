"""What is optimised: path encoding, length, degree of collision, fitness, repair."""

from swarm_gym.problem.problem import Problem

__all__ = ["Problem"]

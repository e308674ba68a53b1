"""Swarm optimizers for robot path planning, one iteration at a time, as Gymnasium environments.

Importing this package registers the environments:

    import gymnasium
    import swarm_gym

    env = gymnasium.make("swarm_gym/Firefly-v0", scenario="case1")
"""

from swarm_gym.registration import register_environments

__version__ = "0.1.0"

register_environments()

"""Swarm optimizers for robot path planning, one iteration at a time, as Gymnasium environments.

Importing this package registers the environments:

    import gymnasium
    import swarm_gym

    env = gymnasium.make("swarm_gym/Firefly-v0", scenario="case1")

`swarm_gym.plan(...)` plans a path on a map.
"""

from importlib.metadata import version
from typing import TYPE_CHECKING

from swarm_gym.registration import register_environments

if TYPE_CHECKING:
    from swarm_gym.planning import plan as plan

__all__ = ["plan"]
__version__ = version("swarm_gym")

register_environments()


if not TYPE_CHECKING:

    def plan(*arguments, **options):
        """Return a free path on a map; arguments and errors are those of `swarm_gym.planning.plan`."""
        from swarm_gym import planning  # takes a second to import

        return planning.plan(*arguments, **options)

"""Swarm optimizers for robot path planning, one iteration at a time, as Gymnasium environments.

Importing this package registers the environments:

    import gymnasium
    import swarm_gym

    env = gymnasium.make("swarm_gym/Firefly-v0", scenario="case1")

`swarm_gym.plan(...)` plans a path on a map, `swarm_gym.plan_flight(...)` a flight over terrain.
"""

from importlib.metadata import version
from typing import TYPE_CHECKING

from swarm_gym.registration import register_environments

if TYPE_CHECKING:
    from swarm_gym.planning import plan as plan
    from swarm_gym.planning.flights import plan_flight as plan_flight

__all__ = ["plan", "plan_flight"]
__version__ = version("swarm_gym")

register_environments()


if not TYPE_CHECKING:

    def plan(*arguments, **options):
        """Return a free path on a map; `swarm_gym.planning.plan` lists arguments and errors."""
        from swarm_gym import planning  # takes a second to import

        return planning.plan(*arguments, **options)

    def plan_flight(*arguments, **options):
        """Return a flight over terrain, as `swarm_gym.planning.flights.plan_flight` does."""
        from swarm_gym.planning import flights

        return flights.plan_flight(*arguments, **options)

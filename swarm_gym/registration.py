"""Ids of the environments in Gymnasium's registry: `swarm_gym/<Optimizer>-v0`."""

import gymnasium

from swarm_gym.checks import look_up
from swarm_gym.optimizers import OPTIMIZERS


def environment_id(optimizer: str) -> str:
    """Return the id of an optimizer's environment, e.g. `swarm_gym/Firefly-v0` for `firefly`.

    Raises:
        UnknownNameError: if there is no optimizer of that name.
    """
    return f"swarm_gym/{look_up('optimizer', optimizer, OPTIMIZERS)[1]}-v0"


def register_environments() -> None:
    """Register an environment for every optimizer, single and vector."""
    for optimizer in OPTIMIZERS:
        gymnasium.register(
            environment_id(optimizer),
            entry_point="swarm_gym.env:SwarmEnv",
            vector_entry_point="swarm_gym.vector_env:SwarmVectorEnv",
            kwargs={"optimizer": optimizer},
        )

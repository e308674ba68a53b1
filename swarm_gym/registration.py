"""Ids of the environments in Gymnasium's registry: `swarm_gym/<Optimizer>-v0`.

A process knows them once it has imported `swarm_gym`. Worker processes that start afresh (spawn, forkserver)
have not, and Gymnasium has no plug-ins since version 1.0. The id `swarm_gym:swarm_gym/Firefly-v0` imports the
package first, so that it works in every process.
"""

import re

import gymnasium

from swarm_gym.optimizers import ALL_OPTIMIZERS, SPECIAL_OPTIMIZERS, get_optimizer

NO_PART_OF_AN_ID = r"[^\w.-]"  # as may stand in the name of an entry point


def environment_id(optimizer: str) -> str:
    """Return the id of an optimizer's environment, e.g. `swarm_gym/Firefly-v0` for `firefly`.

    The environment of own code, `module:Class`, is `module/Class-v0`, with `-` for dots in the module. That
    of an entry point has the module of the class and the name of the entry point. It is registered here.

    Raises:
        UnknownNameError: if there is no optimizer of that name.
        OwnCodeError: if own code cannot be imported, or is no optimizer.
    """
    if optimizer in ALL_OPTIMIZERS:
        return f"swarm_gym/{ALL_OPTIMIZERS[optimizer][1]}-v0"
    found = get_optimizer(optimizer)
    module, _, attribute = optimizer.rpartition(":")  # several names may stand for classes of one name
    module = (module or found.__module__).replace(".", "-")
    name = f"{module}/{re.sub(NO_PART_OF_AN_ID, '-', attribute)}-v0"
    _register(name, optimizer)
    return name


def register_environments() -> None:
    """Register an environment for every optimizer, single and vector."""
    for optimizer in ALL_OPTIMIZERS:
        _register(environment_id(optimizer), optimizer)


def _register(name: str, optimizer: str) -> None:
    """Register an environment, unless it is: Gymnasium would warn of a second time, as after a reload."""
    if name in gymnasium.registry:
        return
    gymnasium.register(
        name,
        entry_point="swarm_gym.env:SwarmEnv",
        vector_entry_point="swarm_gym.vector_env:SwarmVectorEnv",
        kwargs={"optimizer": optimizer},
        # It would warn of the repair degree, which is always 0.
        disable_env_checker=optimizer in SPECIAL_OPTIMIZERS,
    )

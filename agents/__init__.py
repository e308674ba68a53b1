"""Commands that train, tune, distil and convert controllers, on this machine and on clusters.

`make_controller` and the controllers themselves are in `swarm_gym.controllers`, and re-exported here.
"""

from typing import TYPE_CHECKING

from swarm_gym import controllers

if TYPE_CHECKING:
    from swarm_gym.controllers import (
        CONTROLLERS,
        Controller,
        SizeLimits,
        make_controller,
        make_controller_for,
    )

__all__ = ["CONTROLLERS", "Controller", "SizeLimits", "make_controller", "make_controller_for"]


def __getattr__(name: str) -> object:
    # Imported at its first use, as there.
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(controllers, name)

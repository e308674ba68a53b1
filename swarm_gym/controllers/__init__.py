"""Controllers that decide the next population size and repair degree, made by name; torch is not needed."""

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from swarm_gym.controllers.controller import Controller
    from swarm_gym.controllers.registry import CONTROLLERS, make_controller
    from swarm_gym.controllers.size_limits import SizeLimits

__all__ = ["CONTROLLERS", "Controller", "SizeLimits", "make_controller"]

# Module of each name; it is imported at its first use, since the registry imports the whole simulation.
_MODULES = {
    "CONTROLLERS": "registry",
    "Controller": "controller",
    "SizeLimits": "size_limits",
    "make_controller": "registry",
}


def __getattr__(name: str) -> object:
    if name not in _MODULES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_MODULES[name]}"), name)

"""Controllers that decide the next population size and repair degree, made by name; torch is not needed."""

from typing import TYPE_CHECKING

from swarm_gym.lazy import lazy_names

if TYPE_CHECKING:
    from swarm_gym.controllers.controller import Controller
    from swarm_gym.controllers.registry import CONTROLLERS, make_controller, make_controller_for
    from swarm_gym.controllers.size_limits import SizeLimits

__all__ = ["CONTROLLERS", "Controller", "SizeLimits", "make_controller", "make_controller_for"]

# The registry imports the whole simulation.
__getattr__ = lazy_names(
    __name__,
    {
        "CONTROLLERS": "registry",
        "Controller": "controller",
        "SizeLimits": "size_limits",
        "make_controller": "registry",
        "make_controller_for": "registry",
    },
)

"""Everything that decides the next population size and repair degree, made by name; needs no torch."""

from swarm_gym.controllers.controller import Controller, SizeLimits
from swarm_gym.controllers.registry import CONTROLLERS, make_controller

__all__ = ["CONTROLLERS", "Controller", "SizeLimits", "make_controller"]

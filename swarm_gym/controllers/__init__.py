"""Controllers that decide the next population size and repair degree, made by name; torch is not needed."""

from swarm_gym.controllers.controller import Controller, SizeLimits
from swarm_gym.controllers.registry import CONTROLLERS, make_controller

__all__ = ["CONTROLLERS", "Controller", "SizeLimits", "make_controller"]

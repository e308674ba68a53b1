"""Training, tuning and distillation of controllers; the modules at the top are commands.

`make_controller` and the controllers themselves are in `swarm_gym.controllers`, and re-exported here.
"""

from swarm_gym.controllers import CONTROLLERS, Controller, SizeLimits, make_controller

__all__ = ["CONTROLLERS", "Controller", "SizeLimits", "make_controller"]

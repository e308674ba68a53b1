"""How controllers come about: training, tuning and distilling, started by commands.

`make_controller` and the controllers themselves are in `swarm_gym.controllers`; the names are repeated here.
"""

from swarm_gym.controllers import CONTROLLERS, Controller, SizeLimits, make_controller

__all__ = ["CONTROLLERS", "Controller", "SizeLimits", "make_controller"]

"""Commands that train, tune, distil and convert controllers, on this machine and on clusters.

`make_controller` and the controllers themselves are in `swarm_gym.controllers`, and re-exported here.
"""

from swarm_gym.controllers import CONTROLLERS, Controller, SizeLimits, make_controller

__all__ = ["CONTROLLERS", "Controller", "SizeLimits", "make_controller"]

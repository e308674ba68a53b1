"""Pictures of a running swarm, drawn with pygame, which is imported only for the first picture."""

from swarm_gym.rendering.pen import DESIGN, HEIGHTS, WIDTHS
from swarm_gym.rendering.renderer import Renderer
from swarm_gym.rendering.scene import Scene

__all__ = ["DESIGN", "HEIGHTS", "WIDTHS", "Renderer", "Scene"]

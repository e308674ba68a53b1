"""True optima of problems, where they can be computed, and shortest paths."""

from typing import TYPE_CHECKING

from swarm_gym.lazy import lazy_names
from swarm_gym.reference.optima import gap_to_optimum, known_optimum
from swarm_gym.reference.quick import quick_optima

if TYPE_CHECKING:
    from swarm_gym.reference.a_star import GridPath, shortest_grid_path, smooth
    from swarm_gym.reference.any_angle import AnyAnglePlanner
    from swarm_gym.reference.disc_planner import DiscPlanner
    from swarm_gym.reference.shortest import known_robot_path, shortest_path, shortest_robot_path
    from swarm_gym.reference.waypoint_optimum import ensure_optima, optimum

__all__ = [
    "AnyAnglePlanner",
    "DiscPlanner",
    "GridPath",
    "ensure_optima",
    "gap_to_optimum",
    "known_optimum",
    "known_robot_path",
    "optimum",
    "quick_optima",
    "shortest_grid_path",
    "shortest_path",
    "shortest_robot_path",
    "smooth",
]

# Environments need `known_optimum` only; the modules that compute are imported when first used.
__getattr__ = lazy_names(
    __name__,
    {
        "AnyAnglePlanner": "any_angle",
        "DiscPlanner": "disc_planner",
        "GridPath": "a_star",
        "ensure_optima": "waypoint_optimum",
        "known_robot_path": "shortest",
        "optimum": "waypoint_optimum",
        "shortest_grid_path": "a_star",
        "shortest_path": "shortest",
        "shortest_robot_path": "shortest",
        "smooth": "a_star",
    },
)

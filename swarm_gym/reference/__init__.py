"""The true optimum of a problem, where it can be computed."""

from typing import TYPE_CHECKING, Any

from swarm_gym.reference.optima import known_optimum

if TYPE_CHECKING:
    from swarm_gym.reference.visibility import shortest_path
    from swarm_gym.reference.waypoint_optimum import optimum

__all__ = ["known_optimum", "optimum", "shortest_path"]


def __getattr__(name: str) -> Any:
    # Environments need `known_optimum` only; the modules that compute are imported when first used.
    if name == "optimum":
        from swarm_gym.reference.waypoint_optimum import optimum

        return optimum
    if name == "shortest_path":
        from swarm_gym.reference.visibility import shortest_path

        return shortest_path
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")

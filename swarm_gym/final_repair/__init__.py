"""Final repair: a path that is nearly free is pushed out of obstacles and pulled tight."""

from swarm_gym.final_repair.repair import FinalRepair, final_repair

__all__ = ["FinalRepair", "final_repair"]

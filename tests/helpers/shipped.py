"""Files of controllers that ship, by what they are for."""

from swarm_gym.controllers.learned.policy_file import load_policy, packaged_policies, resolve
from swarm_gym.optimizers import SPECIAL_OPTIMIZERS


def policies_on_maps():
    """Return the policies that ship, without those of bit strings, test functions, terrain and wishes."""
    return [name for name in packaged_policies() if _is_on_maps(load_policy(resolve(name))[1])]


def policies_of_wishes():
    """Return the policies that ship for sums of wishes on grid maps, whose least fitness is unknown."""
    return [name for name in packaged_policies() if _has_wishes(load_policy(resolve(name))[1])]


def _has_wishes(manifest):
    return manifest["config"].get("distance_weight", 0.0) > 0.0


def _is_on_maps(manifest):
    trained_on = manifest["config"].get("scenarios", ["case1"])[0]
    elsewhere = trained_on.startswith(("function:", "metabox-bbob:", "terrain:"))
    return manifest["optimizer"] not in SPECIAL_OPTIMIZERS and not elsewhere and not _has_wishes(manifest)

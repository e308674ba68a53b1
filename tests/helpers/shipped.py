"""Files of controllers that ship, by what they are for."""

from swarm_gym.controllers.learned.policy_file import load_policy, packaged_policies, resolve
from swarm_gym.optimizers import SPECIAL_OPTIMIZERS


def policies_on_maps():
    """Return the names of the policies that ship, without those of optimizers that have no maps."""
    return [
        name
        for name in packaged_policies()
        if load_policy(resolve(name))[1]["optimizer"] not in SPECIAL_OPTIMIZERS
    ]

"""Learned controllers from their files: which class one is of is told by its manifest."""

import os
from pathlib import Path

from swarm_gym.controllers.controller import SizeLimits
from swarm_gym.controllers.learned.feedforward import FeedforwardController
from swarm_gym.controllers.learned.policy_file import PolicyFileError, load_policy, resolve
from swarm_gym.controllers.learned.recurrent import RecurrentController
from swarm_gym.errors import shown

NETWORKS: dict[str, type[FeedforwardController]] = {
    network.network: network for network in (FeedforwardController, RecurrentController)
}


def load_learned(policy: str | Path, limits: SizeLimits = SizeLimits()) -> FeedforwardController:  # noqa: B008
    """The controller of a shipped policy by name, or of a policy file; `<policy>@<price>` tells it a price.

    Raises:
        PolicyFileError: if the file is missing, damaged, or made for something else.
    """
    name, at, told = ("", "", str(policy)) if os.path.isfile(policy) else str(policy).rpartition("@")
    path, price = resolve(name if at else told), None
    if at:
        try:
            price = float(told)
        except ValueError as error:
            raise PolicyFileError(f"policy {shown(str(policy))}: {shown(told)} is not a price") from error
    weights, manifest = load_policy(path)
    network = manifest.get("network", FeedforwardController.network)  # the first files did not name theirs
    return NETWORKS[network](path, weights, manifest, limits, price)

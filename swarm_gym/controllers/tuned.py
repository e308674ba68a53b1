"""Tuned controllers: files with the name of a controller, its parameters, and their origin.

`swarm_gym.tuning` writes them. `tuned:<name or path>` is the controller that the file names, with the
population sizes that it was tuned with.
"""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import NamedTuple, cast

from swarm_gym.controllers.controller import SizeLimits
from swarm_gym.controllers.names import ControllerName
from swarm_gym.controllers.packaged import DATA, Packaged, find_json, read_json
from swarm_gym.errors import shown
from swarm_gym.files import write_atomically

FORMAT = "swarm_gym tuned controller 1"
_DEFAULT_SIZES = {"min": SizeLimits.smallest, "max": SizeLimits.largest}
TUNED = Packaged(DATA / "tuned", ".json")


class TunedFileError(ValueError):
    """A file of a tuned controller that is missing or damaged; the message names it."""


class Tuned(NamedTuple):
    """The content of a file: a controller by name and parameters, and the sizes it was tuned with."""

    controller: str
    limits: SizeLimits


def packaged_tuned() -> list[str]:
    """Return the names of the tuned controllers in the package."""
    return TUNED.names()


def load_tuned(name: str) -> Tuned:
    """Return the content of a packaged file, found by its name, or of the file at a path.

    Files whose manifest has no sizes have those that environments have by default.

    Raises:
        TunedFileError: if there is no such file, or its content is invalid.
    """
    path = find_json("tuned controller", name, TUNED, TunedFileError)
    try:
        content = read_json(path, FORMAT)
        controller = content["controller"]
        # Files of these two families name other controllers, and could name each other for ever.
        if not isinstance(controller, str) or ControllerName.parse(controller).family in ("tuned", "learned"):
            raise ValueError(
                f"expected the name of a controller with its parameters, got {shown(controller)}"
            )
        manifest = cast(Mapping[str, Mapping[str, int]], content.get("manifest", {}))
        config = manifest.get("config", {})
        sizes = (config.get(f"{end}_population_size", default) for end, default in _DEFAULT_SIZES.items())
        return Tuned(controller, SizeLimits(*sizes))
    except (OSError, KeyError, TypeError, AttributeError, ValueError) as error:
        raise TunedFileError(f"{path}: not a readable tuned controller ({error})") from error


def save_tuned(path: Path, controller: str, manifest: Mapping[str, object]) -> None:
    """Write the name of a controller and the manifest of its origin to a file, atomically."""
    content = {"format": FORMAT, "controller": controller, "manifest": dict(manifest)}
    write_atomically(path, json.dumps(content, indent=2) + "\n")

"""Tuned controllers: files with the name of a controller, its parameters, and their origin.

`agents.tune` writes them. `tuned:<name or path>` is the controller that the file names.
"""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from swarm_gym.controllers.names import ControllerName
from swarm_gym.controllers.packaged import find_json, packaged_names, read_json
from swarm_gym.errors import shown
from swarm_gym.files import write_atomically

FORMAT = "swarm_gym tuned controller 1"
TUNED = Path(__file__).parent / "data" / "tuned"


class TunedFileError(ValueError):
    """A file of a tuned controller that is missing or damaged; the message names it."""


def packaged_tuned() -> list[str]:
    """Return the names of the tuned controllers in the package."""
    return packaged_names(TUNED, ".json")


def load_tuned(name: str) -> str:
    """Return the controller's name in a packaged file, found by its name, or in the file at a path.

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
    except (OSError, KeyError, TypeError, ValueError) as error:
        raise TunedFileError(f"{path}: not a readable tuned controller ({error})") from error
    return controller


def save_tuned(path: Path, controller: str, manifest: Mapping[str, Any]) -> None:
    """Write the name of a controller and the manifest of its origin to a file, atomically."""
    content = {"format": FORMAT, "controller": controller, "manifest": dict(manifest)}
    write_atomically(path, json.dumps(content, indent=2) + "\n")

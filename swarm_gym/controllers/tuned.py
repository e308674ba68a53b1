"""Tuned controllers: files that hold the name of a controller with its parameters, and where these come from.

Written by `agents.tune`. `tuned:<name or path>` is the controller that the file names.
"""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from swarm_gym.controllers.packaged import find_json, read_json, shipped_names
from swarm_gym.errors import shown
from swarm_gym.files import write_atomically

FORMAT = "swarm_gym tuned controller 1"
TUNED = Path(__file__).parent / "data" / "tuned"


class TunedFileError(ValueError):
    """A file of a tuned controller is missing or damaged; the message names it."""


def shipped_tuned() -> list[str]:
    """Names of the tuned controllers that come with the project."""
    return shipped_names(TUNED, ".json")


def load_tuned(name: str) -> str:
    """What `make_controller` makes the controller of, from a shipped file by name, or from the file given.

    Raises:
        TunedFileError: if there is none, or its content is not what it should be.
    """
    path = find_json("tuned controller", name, TUNED, TunedFileError)
    try:
        content = read_json(path, FORMAT)
        controller = content["controller"]
        # Files of these two families may name others, and so each other for ever.
        if not isinstance(controller, str) or controller.partition(":")[0] in ("tuned", "learned"):
            raise ValueError(
                f"expected the name of a controller with its parameters, got {shown(controller)}"
            )
    except (OSError, KeyError, TypeError, ValueError) as error:
        raise TunedFileError(f"{path}: not a readable tuned controller ({error})") from error
    return controller


def save_tuned(path: Path, controller: str, manifest: Mapping[str, Any]) -> None:
    """Write the name of a controller with what is known of it, at once or not at all."""
    content = {"format": FORMAT, "controller": controller, "manifest": dict(manifest)}
    write_atomically(path, json.dumps(content, indent=2) + "\n")

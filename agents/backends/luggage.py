"""What workers on other machines need to have: our code, the maps, and the files that names lead to."""

import os
from collections.abc import Iterable, Iterator
from pathlib import Path

from agents.policy_file import SUFFIX, load_policy
from agents.provenance import COMMIT, git_commit
from swarm_gym.scenarios.data_files import DATA, data_folder

PACKAGES = ("swarm_gym", "agents", "experiments")
MAPS = "maps"
LEFT_BEHIND = ["**/__pycache__"]


def pack(folder: Path, files: Iterable[Path]) -> dict[str, str]:
    """Make a folder which, once workers are in it, is to them what this one is here; it has links only.

    Args:
        folder: an empty one.
        files: those whose paths are relative to here; other paths have to lead to the same files everywhere.

    Returns:
        What has to be set in the environment of the workers.
    """
    for package in PACKAGES:
        (folder / package).symlink_to(Path(__file__).parents[2] / package)
    if data_folder().is_dir():
        (folder / MAPS).symlink_to(data_folder().resolve())
    for file in files:
        place = folder / file
        if not file.is_absolute() and ".." not in file.parts and not place.exists():
            place.parent.mkdir(parents=True, exist_ok=True)
            place.symlink_to(file.resolve())
    return {DATA: MAPS, COMMIT: git_commit()}


def files_of(controllers: Iterable[str]) -> Iterator[Path]:
    """The files that names of controllers lead to by a path: policies and what they correct, open loops.

    Raises:
        PolicyFileError: if a policy is damaged.
    """
    for name in controllers:
        _, _, argument = name.partition(":")
        without_price, _, _ = argument.rpartition("@")
        for path in (argument, without_price):
            if path and os.path.isfile(path):
                yield Path(path)
                if path.endswith(SUFFIX):
                    yield from files_of([load_policy(Path(path))[1].get("base", "none")])

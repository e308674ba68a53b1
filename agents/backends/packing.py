"""What workers on other machines need to have: our code, the maps, and the files that names lead to."""

import os
from collections.abc import Iterable, Iterator
from pathlib import Path

from agents.backends.backend import BackendError
from agents.runs.provenance import COMMIT, git_commit
from swarm_gym.controllers.learned.policy_file import SUFFIX, load_policy
from swarm_gym.scenarios.formats.data_files import DATA, data_folder

PACKAGES = ("swarm_gym", "agents", "experiments")
MAPS = "swarm_gym_maps"
LEFT_BEHIND = ["**/__pycache__"]


def pack(folder: Path, files: Iterable[Path]) -> dict[str, str]:
    """Make a folder which, once workers are in it, is to them what this one is here; it has links only.

    Args:
        folder: an empty one.
        files: brought along where their paths are relative; others have to lead to the same files everywhere.

    Returns:
        What has to be set in the environment of the workers.

    Raises:
        BackendError: for a relative path that cannot be the same there.
    """
    for package in PACKAGES:
        (folder / package).symlink_to(Path(__file__).parents[2] / package)
    if data_folder().is_dir():
        (folder / MAPS).symlink_to(data_folder().resolve())
    linked = {path.name for path in folder.iterdir()}
    for file in files:
        place = folder / file
        goes_up = ".." in file.parts
        if file.is_absolute() or (not goes_up and place.exists() and place.samefile(file)):
            continue
        if goes_up or file.parts[0] in linked:
            raise BackendError(
                f"{file} is not brought to other machines: give a path that they all see, or one below this "
                f"folder and none of {', '.join(sorted(linked))}"
            )
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

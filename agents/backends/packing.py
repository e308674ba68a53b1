"""Packing of files that workers on other machines need: the code, the maps and the files of controllers."""

import os
from collections.abc import Iterable, Iterator
from pathlib import Path

from agents.backends.backend import BackendError
from agents.runs.provenance import COMMIT, git_commit
from swarm_gym.controllers.learned.policy_file import SUFFIX, load_policy
from swarm_gym.controllers.names import ControllerName
from swarm_gym.own_code import source_files
from swarm_gym.scenarios.formats.data_files import DATA, data_folder

PACKAGES = ("swarm_gym", "agents", "experiments")
MAPS = "swarm_gym_maps"
LEFT_BEHIND = ["**/__pycache__"]


def pack(folder: Path, files: Iterable[Path]) -> dict[str, str]:
    """Fill a folder with links, so that workers inside it find the same files as this process does here.

    Args:
        folder: an empty folder.
        files: files to pack if their paths are relative; absolute paths must be valid on all machines.

    Returns:
        Environment variables to set for the workers.

    Raises:
        BackendError: for a relative path that cannot be valid in the folder.
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
                f"{file} is not copied to other machines: give a path that they all see, or one below this "
                f"folder, outside of {', '.join(sorted(linked))}"
            )
        place.parent.mkdir(parents=True, exist_ok=True)
        place.symlink_to(file.resolve())
    return {DATA: MAPS, COMMIT: git_commit()}


def files_of(controllers: Iterable[str]) -> Iterator[Path]:
    """Yield the files that names of controllers give as paths, and those of the bases of policies.

    Raises:
        PolicyFileError: if a policy is damaged.
    """
    for controller in controllers:
        name = ControllerName.parse(controller)
        for path in dict.fromkeys((name.argument, name.without_price.argument)):
            if path and os.path.isfile(path):
                yield Path(path)
                if path.endswith(SUFFIX):
                    yield from files_of([load_policy(Path(path))[1]["base"]])


def own_files() -> Iterator[Path]:
    """Yield the modules of own code that was named so far, and the modules beside them, relative to here.

    Code of installed packages is left out: it has to be installed on all machines.

    Raises:
        BackendError: for a module that lies neither below this folder nor in an installed package.
    """
    here = Path.cwd().resolve()
    for name, file in sorted(source_files().items()):
        if not file.is_relative_to(here):
            raise BackendError(
                f"{name} is not copied to other machines: its module {file} is outside of this folder, {here}"
            )
        beside = [file] if file.parent == here else sorted(file.parent.rglob("*.py"))
        yield from (path.relative_to(here) for path in beside)

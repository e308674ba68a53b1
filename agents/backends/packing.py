"""Packing of files that workers on other machines need: the code, the maps and the files of controllers."""

import os
import shutil
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path

from agents.backends.backend import BackendError
from swarm_gym.controllers.names import ControllerName
from swarm_gym.own_code import source_files
from swarm_gym.runs.provenance import COMMIT, git_commit
from swarm_gym.scenarios.formats.data_files import DATA, data_folder

PACKAGES = ("swarm_gym", "agents", "experiments")
MAPS = "swarm_gym_maps"
LEFT_BEHIND = ["**/__pycache__"]


def pack(folder: Path, files: Iterable[Path]) -> dict[str, str]:
    """Fill a folder with links, so that workers inside it find the same files as this process does here.

    Where the system refuses links, as Windows does to most users, the files are copied.

    Args:
        folder: an empty folder.
        files: files to pack if their paths are relative; absolute paths must be valid on all machines.

    Returns:
        Environment variables to set for the workers.

    Raises:
        BackendError: for a relative path that cannot be valid in the folder.
    """
    targets = {package: Path(__file__).parents[2] / package for package in PACKAGES}
    if data_folder().is_dir():
        targets[MAPS] = data_folder().resolve()
    for name, target in targets.items():
        _link(folder / name, target)
    for file in files:
        place = folder / file
        goes_up = ".." in file.parts
        if file.is_absolute() or (not goes_up and _is_packed(file, place, targets)):
            continue
        if goes_up or file.parts[0] in targets:
            raise BackendError(
                f"{file} is not copied to other machines: give a path that they all see, or one below this "
                f"folder, outside of {', '.join(sorted(targets))}"
            )
        place.parent.mkdir(parents=True, exist_ok=True)
        _link(place, file.resolve())
    return {DATA: MAPS, COMMIT: git_commit()}


def _is_packed(file: Path, place: Path, targets: Mapping[str, Path]) -> bool:
    """Return whether a relative path leads, in the packed folder, to the file that it leads to here."""
    first, *rest = file.parts
    there = targets[first].joinpath(*rest) if first in targets else place
    return there.exists() and (first not in targets or there.samefile(file))


def _link(place: Path, target: Path) -> None:
    """Make a link to a file or folder, or a copy of it where the system refuses links."""
    try:
        place.symlink_to(target, target_is_directory=target.is_dir())
    except (OSError, NotImplementedError):
        if target.is_dir():
            shutil.copytree(target, place, ignore=shutil.ignore_patterns("__pycache__"))
        else:
            shutil.copy2(target, place)


def files_of(controllers: Iterable[str]) -> Iterator[Path]:
    """Yield the files that names of controllers give as paths, and those of the bases of policies.

    Raises:
        PolicyFileError: if a policy is damaged.
    """
    from swarm_gym.controllers.learned.policy_file import POLICIES, load_policy

    for controller in controllers:
        name = ControllerName.parse(controller)
        for path in dict.fromkeys((name.argument, name.without_price.argument)):
            if path and os.path.isfile(path):
                yield Path(path)
                if path.endswith(POLICIES.suffix):
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

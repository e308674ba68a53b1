"""The 56 published terrains, for whoever has their file: the scenarios `uav56:<number>`, 0 to 55.

Source: M. A. Shehadeh and J. Kudela, Zenodo record 12793991 (2024), as MetaBox reads them from `Model56.pkl`.
Neither is part of this package. `python -m swarm_gym.scenarios.terrain.convert_uav56 Model56.pkl` writes
`uav56.npz` into the data folder, from which these scenarios are read.
"""

import zipfile
import zlib
from collections.abc import Mapping
from functools import lru_cache
from pathlib import Path

import numpy as np

from swarm_gym.errors import ScenarioError, shown
from swarm_gym.scenarios.family import Family, numbers_below
from swarm_gym.scenarios.formats.data_files import data_folder, find_data_file, open_file, stamp_of
from swarm_gym.scenarios.terrain.generated import as_scenario
from swarm_gym.scenarios.terrain.generator import Floats, Terrain
from swarm_gym.scenarios.terrain.scenario import TerrainScenario

NAME = "uav56"
USAGE = f"{NAME}:<number>"
FILE = "uav56.npz"
COUNT = 56
COMMAND = "python -m swarm_gym.scenarios.terrain.convert_uav56"


def expand(name: str) -> tuple[str, ...]:
    """Return the names of the single terrains that a name stands for; `uav56:0-55` stands for all.

    Raises:
        ScenarioError: if the name has another form, or a number is too large.
    """
    numbers = numbers_below(COUNT, name.partition(":")[2], name, f"0-{COUNT - 1}", f"{NAME}:")
    return tuple(f"{NAME}:{number}" for number in numbers)


def make(name: str) -> TerrainScenario:
    """Return the single terrain of that name.

    Raises:
        ScenarioError: if the file is missing or damaged, or the terrain is no well-formed task.
    """
    try:
        path = find_data_file(FILE)
    except ScenarioError as error:
        raise ScenarioError(
            f"scenario {shown(name)}: no file {FILE} in the data folder {data_folder()}; "
            f"`{COMMAND} Model56.pkl` makes it from the published file"
        ) from error
    return as_scenario(name, _terrain(path, int(name.partition(":")[2]), stamp_of(path)))


FAMILY = Family(USAGE, (), expand, make)


def fault_of(parts: Mapping[str, Floats]) -> str | None:
    """Return what is wrong with the shapes of the arrays of a terrain by name, or None."""
    expected = {"heights": (None, None), "threats": (None, 4), "start": (3,), "goal": (3,)}
    for name, shape in expected.items():
        found = parts[name].shape
        if len(found) != len(shape) or any(
            size not in (None, has) for size, has in zip(shape, found, strict=True)
        ):
            words = " x ".join("any" if size is None else str(size) for size in shape)
            return f"{name} must be {words} numbers, got an array of shape {found}"
    return None


@lru_cache(maxsize=8)
def _terrain(path: Path, number: int, _stamp: tuple[int, int]) -> Terrain:
    try:
        with open_file(path) as file, np.load(file, allow_pickle=False) as found:
            heights, threats, start, goal = (
                np.asarray(found[f"{part}_{number}"], dtype=np.float64)
                for part in ("heights", "threats", "start", "goal")
            )
    except (OSError, ValueError, KeyError, EOFError, TypeError, zipfile.BadZipFile, zlib.error) as error:
        raise ScenarioError(
            f"{path}: cannot be read: {error}; make it again with `{COMMAND} Model56.pkl`"
        ) from error
    parts = {"heights": heights, "threats": threats, "start": start, "goal": goal}
    if (fault := fault_of(parts)) is not None:
        raise ScenarioError(f"{path}: terrain {number}: {fault}; make it again with `{COMMAND} Model56.pkl`")
    (x, y, z), (goal_x, goal_y, goal_z) = start.tolist(), goal.tolist()
    return Terrain(heights, threats, (x, y, z), (goal_x, goal_y, goal_z))

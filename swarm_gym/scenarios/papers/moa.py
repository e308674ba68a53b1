"""Six tasks on the map of the MOA paper: the scenarios `den400d:P1` to `den400d:P6`.

Source: Li et al., "A path planner based on multivariate optimization algorithm", Acta Electronica Sinica
44(9), 2016. The paper plans on map den400d of the Moving AI benchmarks, but shows the ends of its tasks P1 to
P6 in a figure only. The tasks here replace them. They are problems of the benchmark whose shortest paths are
2 to 4 percent shorter than the paths in the paper's tables. Coordinates are cells (x, y), see
`swarm_gym.scenarios.formats.moving_ai`.
"""

import re

from swarm_gym.errors import ScenarioError, shown
from swarm_gym.scenarios.family import Family
from swarm_gym.scenarios.formats.data_files import find_data_file
from swarm_gym.scenarios.formats.moving_ai import cached_map
from swarm_gym.scenarios.grid_map import Cell
from swarm_gym.scenarios.grid_scenario import GridScenario

NAME = "den400d"
USAGE = f"{NAME}:P<number>"

# Cells (x, y) of start and goal, by task.
TASKS: dict[str, tuple[Cell, Cell]] = {
    "P1": ((100, 118), (238, 107)),
    "P2": ((100, 196), (218, 184)),
    "P3": ((105, 225), (230, 91)),
    "P4": ((100, 53), (122, 218)),
    "P5": ((11, 189), (222, 122)),
    "P6": ((10, 161), (165, 27)),
}

# `GridMap.digest` of the map in the benchmark.
DIGEST = "23f04fb920fc128f81c02119a2f18a7ec69ec07bbbe7e2e27b91437fa389b8e7"


def expand(name: str) -> tuple[str, ...]:
    """Return the names of the single tasks that a name stands for; `den400d:P1-P6` stands for all six.

    Raises:
        ScenarioError: if the name has another form.
    """
    match = re.fullmatch(rf"{NAME}:P([1-6])(?:-P([1-6]))?", name)
    numbers = range(int(match[1]), int(match[2] or match[1]) + 1) if match else range(0)
    if not numbers:
        raise ScenarioError(f"scenario {shown(name)}: expected {USAGE} with a number from 1 to 6, or P1-P6")
    return tuple(f"{NAME}:P{number}" for number in numbers)


def make(name: str) -> GridScenario:
    """Return the single task of that name; its map is the file `den400d.map` in the data folder.

    Raises:
        ScenarioError: if the file is missing or malformed, or is another map.
    """
    path = find_data_file(f"{NAME}.map")
    grid = cached_map(path)
    if grid.digest != DIGEST:
        raise ScenarioError(
            f"scenario {shown(name)}: {path} is not the map {NAME} of the Moving AI benchmarks; replace it, "
            f"`python -m swarm_gym.scenarios.download --force {NAME}` does so"
        )
    return GridScenario(name, grid, *TASKS[name.removeprefix(f"{NAME}:")])


FAMILY = Family(USAGE, (), expand, make)

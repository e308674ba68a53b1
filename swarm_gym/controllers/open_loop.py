"""A blind controller: population size and phi, and further decisions, as fixed functions of the iteration.

The decisions are given at a few iterations, the knots, and interpolated between them: sizes and parameters of
the optimizer in the logarithm, phi in its square root. Where the knots come from is told by their file; see
`agents.tune`.
"""

import json
from collections.abc import Mapping
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from swarm_gym.controllers.controller import Controller, Floats, SizeLimits
from swarm_gym.controllers.packaged import find_json, read_json, shipped_names
from swarm_gym.errors import shown
from swarm_gym.files import write_atomically
from swarm_gym.observation import ITERATION
from swarm_gym.optimizers import get_optimizer

FORMAT = "swarm_gym open loop 2"
OPEN_LOOPS = Path(__file__).parent / "data" / "open_loops"
# Far beyond an episode; the table of decisions has as many rows.
MAX_KNOT = 10**5


class OpenLoopFileError(ValueError):
    """A file of knots is missing or damaged; the message names it."""


class OpenLoop(Controller):
    """Decisions interpolated between knots.

    Args:
        initial_population_size: PS(0); what the first knot says holds from iteration 1 on.
        knots: iterations in increasing order, the first one 0.
        sizes: population size at each knot.
        repair_degrees: phi at each knot, in [0, 1].
        knobs: further decisions at each knot by name, positive, in the order of the extended action.
        limits: the sizes that the environment allows.
        optimizer: the optimizer whose parameters the further decisions are.

    Attributes:
        table: (iterations up to the last knot, number of decisions) what is decided, in natural units.
    """

    def __init__(
        self,
        initial_population_size: int,
        knots: list[int],
        sizes: list[float],
        repair_degrees: list[float],
        knobs: Mapping[str, list[float]] | None = None,
        limits: SizeLimits = SizeLimits(),  # noqa: B008
        optimizer: str = "firefly",
    ):
        knobs = dict(knobs or {})
        columns = [sizes, repair_degrees, *knobs.values()]
        if any(len(column) != len(knots) for column in columns):
            raise ValueError(f"open loop: {len(knots)} knots, but {[len(c) for c in columns]} values")
        whole = all(isinstance(knot, int | np.integer) for knot in knots)
        if not whole or len(knots) < 1 or knots[0] != 0 or any(b <= a for a, b in pairwise(knots)):
            raise ValueError(
                f"open loop: knots must be integers, begin with 0 and increase, got {shown(knots)}"
            )
        if knots[-1] > MAX_KNOT:
            raise ValueError(f"open loop: knots go up to {MAX_KNOT}, got {knots[-1]}")
        positive = [sizes, *knobs.values()]
        if not all(0 < value < np.inf for column in positive for value in column) or not all(
            0 <= degree <= 1 for degree in repair_degrees
        ):
            raise ValueError("open loop: sizes and parameters must be positive and finite, phi in [0, 1]")
        if knobs:
            _check_knobs(knobs, optimizer)
        self.action = "extended" if knobs else "natural"
        if not isinstance(initial_population_size, int | np.integer):
            raise ValueError(
                f"open loop: initial_population_size must be an integer, got {shown(initial_population_size)}"
            )
        self.initial_population_size = limits.clip(int(initial_population_size))
        iterations = np.arange(knots[-1] + 1)
        # Clipped, since exp(log(x)) may be the next number after x, and x the bound of an action.
        table = [
            np.clip(np.exp(np.interp(iterations, knots, np.log(column))), min(column), max(column))
            for column in positive
        ]
        table[0] = np.clip(table[0], limits.smallest, limits.largest)
        table.insert(1, np.interp(iterations, knots, np.sqrt(repair_degrees)) ** 2)
        self.table: Floats = np.stack(table, axis=1)

    def reset(self, num_swarms: int, seed: int = 0) -> None:
        """Nothing to begin."""

    def act(self, observations: NDArray) -> Floats:
        """What the knots say for the next iteration; beyond the last knot it stays as it is."""
        iteration = np.minimum(observations[:, ITERATION].astype(np.int64), len(self.table) - 1)
        return self.table[iteration]


def shipped_open_loops() -> list[str]:
    """Names of the open loops that come with the project."""
    return shipped_names(OPEN_LOOPS, ".json")


def _check_knobs(knobs: Mapping[str, list[float]], optimizer: str) -> None:
    """Refuse what is not decided by an extended action, in its order and within its ranges."""
    declared = get_optimizer(optimizer).decided_parameters()
    decided = {name: parameter.decided for name, parameter in declared.items()}
    if list(knobs) != list(decided):
        raise ValueError(
            f"open loop: further decisions of {optimizer!r} are {', '.join(decided)}, in this order; got "
            f"{', '.join(knobs)}"
        )
    for name, span in decided.items():
        low, high = span or (0.0, 0.0)
        if not all(low <= value <= high for value in knobs[name]):
            raise ValueError(f"open loop: {name} must lie in [{low:g}, {high:g}], got {knobs[name]}")


def load_open_loop(name: str, limits: SizeLimits = SizeLimits()) -> OpenLoop:  # noqa: B008
    """An open loop from a shipped file by name, or from the file that is given.

    Raises:
        OpenLoopFileError: if there is none, or its content is not what it should be.
    """
    path = find_json("open loop", name, OPEN_LOOPS, OpenLoopFileError)
    try:
        content = read_json(path, FORMAT)
        return OpenLoop(
            content["initial_population_size"],
            content["knots"],
            content["sizes"],
            content["repair_degrees"],
            content["knobs"],
            limits,
        )
    except (OSError, KeyError, TypeError, ValueError) as error:
        raise OpenLoopFileError(f"{path}: not a readable open loop ({error})") from error


def save_open_loop(
    path: Path,
    initial_population_size: int,
    knots: list[int],
    sizes: list[float],
    repair_degrees: list[float],
    knobs: Mapping[str, list[float]],
    manifest: Mapping[str, Any],
) -> None:
    """Write knots with what is known of them, at once or not at all."""
    content = {
        "format": FORMAT,
        "initial_population_size": initial_population_size,
        "knots": knots,
        "sizes": sizes,
        "repair_degrees": repair_degrees,
        "knobs": dict(knobs),
        "manifest": dict(manifest),
    }
    write_atomically(path, json.dumps(content, indent=2) + "\n")

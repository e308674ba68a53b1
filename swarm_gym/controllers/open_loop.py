"""Open loops: population size, phi and further decisions as fixed functions of the iteration.

The decisions are given at a few iterations, the knots. Between knots, sizes, parameters of the optimizer and
amplitudes are interpolated in the logarithm, phi and the share of immigrants in their square roots, and the
share of smooth members as it is. The manifest of a file states how its knots
were tuned; see `swarm_gym.tuning`.
"""

import json
from collections.abc import Callable, Mapping
from dataclasses import asdict
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from swarm_gym.checks import require_number
from swarm_gym.compiler.elementary import exp, interpolate, log
from swarm_gym.controllers.controller import Controller, Floats, SizeLimits
from swarm_gym.controllers.packaged import DATA, Packaged, find_json, read_json
from swarm_gym.errors import shown
from swarm_gym.files import write_atomically
from swarm_gym.observation import ITERATION
from swarm_gym.optimizers import OPTIMIZERS, get_optimizer
from swarm_gym.own_code import refuse_unless_given
from swarm_gym.sources import SOURCE_DECISIONS, SOURCE_RANGES, Source

FORMAT = "swarm_gym open loop 2"
OPEN_LOOPS = Packaged(DATA / "open_loops", ".json")
# Far beyond the length of an episode; `OpenLoop.decisions` has a row for each iteration up to the last knot.
MAX_KNOT = 10**5


class OpenLoopFileError(ValueError):
    """A file of knots that is missing or damaged; the message names it."""


class OpenLoop(Controller):
    """Decisions interpolated between knots.

    Args:
        initial_population_size: PS(0); the decision at the first knot is the size of iteration 1.
        knots: iterations in increasing order, the first one 0.
        sizes: population size at each knot.
        repair_degrees: phi at each knot, in [0, 1].
        knobs: further decisions at each knot by name, positive, in the order of the extended action.
        limits: population sizes that the environment allows.
        optimizer: optimizer whose parameters are the further decisions.
        sources: decisions on new members at each knot by name, in the order of `SOURCE_DECISIONS`; without
            them, the environment's source never changes.
        first_source: source of the first population; None is the environment's own.

    Attributes:
        names: names of the decisions; those of sizes and phi are "population size" and "repair degree".
        decisions: (iterations up to the last knot, number of decisions) decisions in natural units.
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
        sources: Mapping[str, list[float]] | None = None,
        first_source: Source | None = None,
    ):
        knobs, sources = dict(knobs or {}), dict(sources or {})
        lengths = [len(values) for values in (sizes, repair_degrees, *knobs.values(), *sources.values())]
        if any(length != len(knots) for length in lengths):
            raise ValueError(f"open loop: {len(knots)} knots, but {lengths} values")
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
        if knobs or sources:
            _check_knobs(knobs, optimizer)
        if sources:
            _check_sources(sources)
        self.action = "sourced" if sources else "extended" if knobs else "natural"
        self.first_source = first_source
        self.made_for = optimizer if knobs else None
        if not isinstance(initial_population_size, int | np.integer):
            raise ValueError(
                f"open loop: initial_population_size must be an integer, got {shown(initial_population_size)}"
            )
        self.initial_population_size = limits.clip(int(initial_population_size))
        self._identity = {
            "optimizer": optimizer,
            "population sizes": limits.identity(),
            "initial population size": int(initial_population_size),
            "knots": [int(knot) for knot in knots],
            "decisions": {
                name: [float(value) for value in column]
                for name, column in (
                    ("population size", sizes),
                    ("repair degree", repair_degrees),
                    *knobs.items(),
                    *sources.items(),
                )
            },
            "first source": first_source.identity() if first_source else None,
        }
        self.names = "population size", "repair degree", *knobs, *sources
        columns = [_between(knots, column, log, exp) for column in positive]
        columns[0] = np.clip(columns[0], limits.smallest, limits.largest)
        columns.insert(1, _between(knots, repair_degrees, np.sqrt, np.square))
        for name, column in sources.items():
            columns.append(_between(knots, column, *_SCALES[name]))
        self.decisions: Floats = np.stack(columns, axis=1)

    def reset(self, num_swarms: int, seed: int = 0) -> None:
        """Do nothing; the controller has no state."""

    def identity(self) -> object:
        """Return the knots and the decisions at them, not those between them, which are computed."""
        return "open loop", self._identity

    def act(self, observations: NDArray) -> Floats:
        """Return (B, k) decisions for the next iteration; those at the last knot hold ever after."""
        iteration = np.minimum(observations[:, ITERATION].astype(np.int64), len(self.decisions) - 1)
        return self.decisions[iteration]


def _between(
    knots: list[int], column: list[float], scale: Callable[[Any], Floats], back: Callable[[Any], Floats]
) -> Floats:
    """Return a decision at every iteration up to the last knot, interpolated on a scale.

    It is clipped, since exp(log(x)) may be the next number after x, and x may be the bound of an action.
    """
    values = back(interpolate(np.arange(knots[-1] + 1), knots, scale(np.asarray(column, dtype=np.float64))))
    return np.clip(values, min(column), max(column))


# The scale on which a decision on new members is interpolated, and its inverse.
_SCALES: dict[str, tuple[Callable[[Any], Floats], Callable[[Any], Floats]]] = {
    "smooth_share": (np.asarray, np.asarray),
    "amplitude": (log, exp),
    "immigrants": (np.sqrt, np.square),
}


def _check_sources(sources: Mapping[str, list[float]]) -> None:
    """Raise an error for decisions on new members that a sourced action cannot have."""
    if tuple(sources) != SOURCE_DECISIONS:
        raise ValueError(
            f"open loop: decisions on new members are {', '.join(SOURCE_DECISIONS)}, in this order; got "
            f"{', '.join(sources)}"
        )
    for name, column in sources.items():
        for value in column:
            require_number(f"open loop: {name}", value, *SOURCE_RANGES[name])


def packaged_open_loops() -> list[str]:
    """Return the names of the open loops in the package."""
    return OPEN_LOOPS.names()


def _check_knobs(knobs: Mapping[str, list[float]], optimizer: str) -> None:
    """Raise an error for decisions that an extended action lacks, in another order or outside its ranges."""
    declared = get_optimizer(optimizer).decided_parameters()
    decided = {name: parameter.decided for name, parameter in declared.items()}
    if list(knobs) != list(decided):
        raise ValueError(
            f"open loop: further decisions of {optimizer!r} are {', '.join(decided)}, in this order; got "
            f"{', '.join(knobs) or 'none'}"
        )
    for name, span in decided.items():
        low, high = span or (0.0, 0.0)
        if not all(low <= value <= high for value in knobs[name]):
            raise ValueError(f"open loop: {name} must lie in [{low:g}, {high:g}], got {knobs[name]}")


def load_open_loop(name: str, limits: SizeLimits = SizeLimits()) -> OpenLoop:  # noqa: B008
    """Return the open loop of a packaged file by its name, or of the file at a path.

    Raises:
        OpenLoopFileError: if there is no such file, or its content is invalid.
    """
    path = find_json("open loop", name, OPEN_LOOPS, OpenLoopFileError)
    try:
        content = read_json(path, FORMAT)
        if (optimizer := content.get("optimizer", "firefly")) not in OPTIMIZERS:
            refuse_unless_given("optimizer", optimizer, "optimizer")
        return OpenLoop(
            content["initial_population_size"],
            content["knots"],
            content["sizes"],
            content["repair_degrees"],
            content["knobs"],
            limits,
            optimizer,
            sources=_decisions_on_sources(content),
            first_source=Source.of(content["first_source"]) if "first_source" in content else None,
        )
    except (OSError, KeyError, TypeError, ValueError) as error:
        raise OpenLoopFileError(f"{path}: not a readable open loop ({error})") from error


def _decisions_on_sources(content: Mapping[str, Any]) -> Mapping[str, list[float]] | None:
    """Return the decisions on new members of a file; None if it has none."""
    if "sources" not in content:
        return None
    sources = content["sources"]
    if not isinstance(sources, dict) or not sources:
        raise ValueError(f"sources must have {', '.join(SOURCE_DECISIONS)}, got {shown(sources)}")
    for name, column in sources.items():
        if not isinstance(column, list):
            raise ValueError(f"{name} must be a list with a number for each knot, got {shown(column)}")
    return sources


def save_open_loop(
    path: Path,
    initial_population_size: int,
    knots: list[int],
    sizes: list[float],
    repair_degrees: list[float],
    knobs: Mapping[str, list[float]],
    manifest: Mapping[str, object],
    sources: Mapping[str, list[float]] | None = None,
    first_source: Source | None = None,
    optimizer: str = "firefly",
) -> None:
    """Write knots and the manifest of their origin to a file, atomically."""
    content = {
        "format": FORMAT,
        "optimizer": optimizer,
        "initial_population_size": initial_population_size,
        "knots": knots,
        "sizes": sizes,
        "repair_degrees": repair_degrees,
        "knobs": dict(knobs),
        **({"sources": dict(sources)} if sources else {}),
        **({"first_source": asdict(first_source)} if first_source else {}),
        "manifest": dict(manifest),
    }
    write_atomically(path, json.dumps(content, indent=2) + "\n")

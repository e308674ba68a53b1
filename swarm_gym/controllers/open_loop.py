"""Open loops: population size, phi and further decisions as fixed functions of the iteration.

The decisions are given at a few iterations, the knots. Between knots, sizes, parameters of the optimizer and
amplitudes are interpolated in the logarithm. Phi and the share of immigrants are interpolated in their square
roots, and the share of smooth members as it is. The manifest of a file states how its knots were tuned; see
`swarm_gym.tuning`.
"""

import json
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from swarm_gym.controllers.controller import Controller, Floats, SizeLimits
from swarm_gym.controllers.knots import Knots
from swarm_gym.controllers.packaged import DATA, Packaged, find_json, read_json
from swarm_gym.files import write_atomically
from swarm_gym.observation import ITERATION

FORMAT = "swarm_gym open loop 2"
OPEN_LOOPS = Packaged(DATA / "open_loops", ".json")


class OpenLoopFileError(ValueError):
    """A file of knots that is missing or damaged; the message names it."""


class OpenLoop(Controller):
    """Decisions interpolated between knots; those at the last knot hold ever after.

    Args:
        knots: decisions at a few iterations.
        limits: population sizes that the environment allows.

    Attributes:
        knots: decisions at a few iterations.
        names: names of the decisions; sizes and phi are "population size" and "repair degree".
        decisions: (iterations up to the last knot, number of decisions) decisions in natural units.
    """

    def __init__(self, knots: Knots, limits: SizeLimits = SizeLimits()):  # noqa: B008
        self.knots = knots
        self.action = knots.action
        self.first_source = knots.first_source
        self.made_for = knots.optimizer if knots.knobs else None
        self.initial_population_size = limits.clip(int(knots.initial_population_size))
        self._limits = limits
        self.names = tuple(knots.columns)
        self.decisions: Floats = knots.between()
        self.decisions[:, 0] = np.clip(self.decisions[:, 0], limits.smallest, limits.largest)

    def reset(self, num_swarms: int, seed: int = 0) -> None:
        """Do nothing; the controller has no state."""

    def identity(self) -> object:
        """Return the knots and the decisions at them, not those between them, which are computed."""
        knots = self.knots
        return "open loop", {
            "optimizer": knots.optimizer,
            "population sizes": self._limits.identity(),
            "initial population size": int(knots.initial_population_size),
            "knots": [int(knot) for knot in knots.iterations],
            "decisions": {name: [float(value) for value in column] for name, column in knots.columns.items()},
            "first source": knots.first_source.identity() if knots.first_source else None,
        }

    def stretched(self, factor: float) -> "OpenLoop":
        """Return the loop with each knot at so many times its iteration, rounded, and after the one before.

        Args:
            factor: number of iterations of an episode, relative to the one that it was made for.

        Raises:
            ValueError: if the last knot is too far away.
        """
        iterations: list[int] = []
        for knot in self.knots.iterations:
            iterations.append(max(round(factor * knot), iterations[-1] + 1 if iterations else 0))
        return OpenLoop(replace(self.knots, iterations=iterations), self._limits)

    def act(self, observations: NDArray) -> Floats:
        """Return (B, k) decisions for the next iteration; those at the last knot hold ever after."""
        iteration = np.minimum(observations[:, ITERATION].astype(np.int64), len(self.decisions) - 1)
        return self.decisions[iteration]


def packaged_open_loops() -> list[str]:
    """Return the names of the open loops in the package."""
    return OPEN_LOOPS.names()


def load_open_loop(name: str, limits: SizeLimits = SizeLimits()) -> OpenLoop:  # noqa: B008
    """Return the open loop of a packaged file by its name, or of the file at a path.

    Raises:
        OpenLoopFileError: if there is no such file, or its content is invalid.
    """
    path = find_json("open loop", name, OPEN_LOOPS, OpenLoopFileError)
    try:
        return OpenLoop(Knots.read(read_json(path, FORMAT)), limits)
    except (OSError, KeyError, TypeError, ValueError) as error:
        raise OpenLoopFileError(f"{path}: not a readable open loop ({error})") from error


def save_open_loop(path: Path, knots: Knots, manifest: Mapping[str, object]) -> None:
    """Write knots and the manifest of their origin to a file, atomically."""
    content = {"format": FORMAT, **knots.content(), "manifest": dict(manifest)}
    write_atomically(path, json.dumps(content, indent=2) + "\n")

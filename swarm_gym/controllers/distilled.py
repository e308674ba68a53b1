"""Distilled rules: controllers with at most ten numbers fitted to the decisions of a trained policy.

A rule is PS(0) and one formula per decision. Phi is a weighted sum of a few inputs; population size and
parameters of the optimizer are the exponential of such a sum. Each is clipped to the bounds of the decision.
The numbers of a rule are PS(0), constants and weights. Inputs are the same for all rules and have no fitted
numbers. `agents.distil` makes rules.
"""

import json
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import NotRequired, TypedDict, cast

import numpy as np
from numpy.typing import NDArray

from swarm_gym.action import make_action
from swarm_gym.compiler.elementary import exp, log
from swarm_gym.controllers.controller import Controller, Floats, SizeLimits
from swarm_gym.controllers.packaged import DATA, Packaged, find_json, read_json
from swarm_gym.errors import shown
from swarm_gym.files import write_atomically
from swarm_gym.observation import OBSERVATIONS
from swarm_gym.optimizers import get_optimizer
from swarm_gym.settings import Settings
from swarm_gym.sources import Source

FORMAT = "swarm_gym distilled rule 1"
DISTILLED = Packaged(DATA / "distilled", ".json")
MOST_NUMBERS = 10
DIGITS = 3  # significant digits of every number
OBSERVATION = "rich"
LINEAR = "repair degree"  # all other decisions are exponentials

_COLUMNS = {feature.name: place for place, feature in enumerate(OBSERVATIONS[OBSERVATION].features)}


class DistilledFileError(ValueError):
    """A file of a rule that is missing or damaged; the message names it."""


def _column(name: str, scale: float = 1.0, power: int = 1) -> Callable[[NDArray], Floats]:
    place = _COLUMNS[name]
    return lambda seen: scale * seen[:, place].astype(np.float64) ** power


CURRENT_SIZE = "log(1+size)/log(1+largest size)"
_TIME = "share of the iterations done"
_LOG_TIME = "log(1 + iteration), relative to that of the last"
# Inputs of formulas by their text: functions from observations (B, k) to (B,). t is the iteration, T the last
# one; "size" is the population size relative to the largest.
INPUTS: dict[str, Callable[[NDArray], Floats]] = {
    "t/T": _column(_TIME),
    "(t/T)^2": _column(_TIME, power=2),
    "log(1+t)/log(1+T)": _column(_LOG_TIME),
    "(log(1+t)/log(1+T))^2": _column(_LOG_TIME, power=2),
    "log(1+E(P))": _column("log(1 + E(P)) / 8", 8.0),
    "log(1+mean collision)": _column("log(1 + mean collision) / 8", 8.0),
    "log(1+deviation of collision)": _column("log(1 + standard deviation of the collision) / 8", 8.0),
    "log(E(P)/first E(P))": _column("log(E(P) / first E(P)) / 8", 8.0),
    CURRENT_SIZE: _column("log population size, relative to that of the largest"),
    "feasible share": _column("feasible share"),
    "log(best/lower bound)": _column("log(best fitness / lower bound)"),
    "log(gap 5 iterations ago/gap)": _column("log(gap 5 iterations ago / gap)"),
    "log(1+diversity)": _column("log(1 + diversity) / 8", 8.0),
    "spent share of the budget": _column("share of the evaluation budget spent"),
}


@dataclass(frozen=True)
class Formula:
    """The formula of one decision: a constant plus weighted inputs, and the exponential of it except for phi.

    Attributes:
        decision: name of the decision in the action layout.
        constant: value of the sum without inputs.
        weights: weights of inputs by their names in `INPUTS`.
    """

    decision: str
    constant: float
    weights: Mapping[str, float]

    def __post_init__(self) -> None:
        unknown = sorted(set(self.weights) - set(INPUTS))
        if unknown:
            raise ValueError(f"unknown inputs {unknown}, expected some of {list(INPUTS)}")
        numbers = (self.constant, *self.weights.values())
        if not all(isinstance(n, int | float) and math.isfinite(n) for n in numbers):
            raise ValueError(f"{self.decision}: a constant or weight is not a finite number: {numbers}")

    @property
    def num_numbers(self) -> int:
        """Number of constants and weights in the formula."""
        return 1 + len(self.weights)

    def rounded(self) -> "Formula":
        """Return the formula with its numbers rounded as they are printed."""
        weights = {name: _round(weight) for name, weight in self.weights.items()}
        return Formula(self.decision, _round(self.constant), weights)

    def evaluate(self, seen: NDArray, low: float, high: float) -> Floats:
        """Return (B,) decisions in natural units within bounds, given observations (B, k), layout `rich`."""
        total = np.full(len(seen), float(self.constant))
        for name, weight in self.weights.items():  # row by row: the width does not matter
            total += weight * INPUTS[name](seen)
        if self.decision == LINEAR:
            return np.clip(total, low, high)
        return np.clip(exp(np.clip(total, *log([low, high]))), low, high)

    def __str__(self) -> str:
        words = [f"{self.constant:.{DIGITS}g}"]
        for name, weight in self.weights.items():
            words.append(f"{'-' if weight < 0 else '+'} {abs(weight):.{DIGITS}g} * {name}")
        total = " ".join(words)
        return f"{self.decision} = {total if self.decision == LINEAR else f'exp({total})'}"


class DistilledRule(Controller):
    """A controller that decides by formulas.

    Args:
        initial_population_size: PS(0).
        formulas: one formula per decision, in the order of the action layout `natural` or `extended`.
        optimizer: optimizer whose parameters are the further decisions.
        max_evaluations: evaluation budget of an episode, if the distilled policy needs one.
        limits: population sizes that the environment allows.
        first_source: source of the first population; None is the environment's own.

    Raises:
        ValueError: for more than `MOST_NUMBERS` numbers, or decisions that no layout has.
    """

    observation = OBSERVATION

    def __init__(
        self,
        initial_population_size: int,
        formulas: Sequence[Formula],
        optimizer: str = "firefly",
        max_evaluations: int | None = None,
        limits: SizeLimits = SizeLimits(),  # noqa: B008
        first_source: Source | None = None,
    ):
        self.formulas = tuple(formula.rounded() for formula in formulas)  # decides as its text says
        self.optimizer = optimizer
        self.action = "natural" if len(self.formulas) == 2 else "extended"
        self.made_for = optimizer if self.action == "extended" else None
        self.max_evaluations = max_evaluations
        self.first_source = first_source
        self.initial_population_size = limits.clip(initial_population_size)
        if self.num_numbers > MOST_NUMBERS:
            raise ValueError(f"a rule has at most {MOST_NUMBERS} numbers, this one has {self.num_numbers}")
        bounds = decision_bounds(limits, optimizer)
        decisions = [formula.decision for formula in self.formulas]
        if decisions not in (list(bounds)[:2], list(bounds)):
            raise ValueError(f"a rule has to decide {list(bounds)[:2]} or {list(bounds)}, not {decisions}")
        self._bounds = [bounds[decision] for decision in decisions]

    @property
    def num_numbers(self) -> int:
        """Number of all fitted numbers: PS(0), constants and weights."""
        return 1 + sum(formula.num_numbers for formula in self.formulas)

    def lines(self) -> list[str]:
        """Return the rule as text."""
        source = self.first_source
        return [
            f"first population size = {self.initial_population_size}",
            *(
                []
                if source is None
                else [f"first members: smooth share {source.smooth_share:g}, amplitude {source.amplitude:g}"]
            ),
            *(
                f"{formula}, within [{low:g}, {high:g}]"
                for formula, (low, high) in zip(self.formulas, self._bounds, strict=True)
            ),
        ]

    def reset(self, num_swarms: int, seed: int = 0) -> None:
        """Do nothing; the controller has no state."""

    def identity(self) -> object:
        """Return the rule as text, which states all its numbers."""
        return "distilled", self.lines(), self.optimizer, self.max_evaluations

    def act(self, observations: NDArray) -> Floats:
        """Return (B, k) decisions of the formulas."""
        return np.stack(
            [
                formula.evaluate(observations, low, high)
                for formula, (low, high) in zip(self.formulas, self._bounds, strict=True)
            ],
            axis=1,
        )


def decision_bounds(limits: SizeLimits, optimizer: str) -> dict[str, tuple[float, float]]:
    """Return the bounds (low, high) of all decisions for an optimizer, in natural units, in order."""
    chosen = get_optimizer(optimizer)
    settings = Settings(
        action="extended" if chosen.decided_parameters() else "natural",
        min_population_size=limits.smallest,
        max_population_size=limits.largest,
        initial_population_size=limits.smallest,
    )
    layout = make_action(settings, chosen)
    return {name: (scale.low, scale.high) for name, scale in zip(layout.labels, layout.scales, strict=True)}


class _Formula(TypedDict):
    decision: str
    constant: float
    weights: dict[str, float]


class _Content(TypedDict):
    """The entries of a file that a rule is read from."""

    rule: list[str]
    initial_population_size: int
    population_sizes: list[int]
    formulas: list[_Formula]
    optimizer: str
    max_evaluations: int | None
    first_source: NotRequired[dict[str, float]]


def packaged_rules() -> list[str]:
    """Return the names of the rules in the package."""
    return DISTILLED.names()


def load_rule(name: str, limits: SizeLimits | None = None) -> DistilledRule:
    """Return the rule of a packaged file by its name, or of the file at a path.

    Its decisions depend on the population sizes that it was made with, which are used where none are given.

    Raises:
        DistilledFileError: if there is no such file, or its content is invalid.
    """
    path = find_json("distilled rule", name, DISTILLED, DistilledFileError)
    try:
        content = cast(_Content, read_json(path, FORMAT))  # wrong types raise one of the errors below
        formulas = [Formula(f["decision"], f["constant"], f["weights"]) for f in content["formulas"]]
        arguments = content["initial_population_size"], formulas, content["optimizer"]
        source = Source.of(content["first_source"]) if "first_source" in content else None
        own_limits = SizeLimits(*content["population_sizes"])
        text = DistilledRule(*arguments, content["max_evaluations"], own_limits, source).lines()
        if content["rule"] != text:
            raise ValueError(f"its text does not say what its numbers do, which is {text}")
        rule = DistilledRule(*arguments, content["max_evaluations"], limits or own_limits, source)
        if limits is None:
            rule.needed_limits = own_limits
        return rule
    except (OSError, AttributeError, KeyError, TypeError, ValueError) as error:
        raise DistilledFileError(f"{path}: not a readable distilled rule ({shown(error)})") from error


def save_rule(path: Path, rule: DistilledRule, limits: SizeLimits, manifest: Mapping[str, object]) -> None:
    """Write a rule, as text and as numbers, with the manifest of its origin, atomically."""
    content = {
        "format": FORMAT,
        "rule": rule.lines(),
        "num_numbers": rule.num_numbers,
        "initial_population_size": rule.initial_population_size,
        "population_sizes": [limits.smallest, limits.largest],
        "formulas": [
            {"decision": f.decision, "constant": f.constant, "weights": dict(f.weights)}
            for f in rule.formulas
        ],
        "optimizer": rule.optimizer,
        "max_evaluations": rule.max_evaluations,
        **({} if rule.first_source is None else {"first_source": asdict(rule.first_source)}),
        "manifest": dict(manifest),
    }
    write_atomically(path, json.dumps(content, indent=2) + "\n")


def _round(number: float) -> float:
    return float(f"{number:.{DIGITS}g}")

"""Distil a trained policy into a rule of at most ten numbers: `python -m agents.distil --help`.

The policy's decisions are collected over episodes of its training, with the inputs that a person can read
(`swarm_gym.controllers.distilled.INPUTS`), and each decision is fitted by a weighted sum of few of them.
What a rule does leads to states that the policy does not visit: in further rounds the policy is asked in
those that the last rule visits, and all are fitted together (S. Ross et al., "A reduction of imitation
learning and structured prediction to no-regret online learning", AISTATS 2011). Of all rules on the way,
with few numbers or many, the one is taken that earns the highest mean return as a controller on validation
seeds.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, NamedTuple

import numpy as np
import tyro
from numpy.typing import NDArray

from agents.evaluation.observers import decision_names, watch
from agents.evaluation.rule_fit import select_forward, share_out
from agents.runs.provenance import provenance
from agents.runs.seeds import ANALYSIS, VALIDATION, training_seed
from agents.training.config import TrainConfig, stored_config
from swarm_gym.command import command
from swarm_gym.controllers import make_controller
from swarm_gym.controllers.controller import Controller
from swarm_gym.controllers.distilled import (
    CURRENT_SIZE,
    INPUTS,
    LINEAR,
    MOST_NUMBERS,
    OBSERVATION,
    DistilledRule,
    Formula,
    decision_bounds,
    save_rule,
)

Floats = NDArray[np.float64]

RIVAL = "spsfa-tip"  # reported on beside policy and rule
SCREENING = 4  # rules are compared on one in so many validation seeds, and the best
FINALISTS = 4  # few of these on all
RUNAWAY = 3.0  # times the most evaluations of the policy, an episode is broken off while screening
# A rule that sees the current size says how to change it; one that does not says what it is.
FAMILIES = (tuple(INPUTS), tuple(name for name in INPUTS if name != CURRENT_SIZE))


@dataclass(frozen=True)
class DistilConfig:
    """Options of a distillation; all are stored with the rule."""

    policy: Annotated[str, tyro.conf.Positional]
    """Controller to distil: learned:<name or file>."""
    output: Path
    """The file to write, a name in swarm_gym/controllers/data/distilled to be found as distilled:<name>."""
    numbers: int = MOST_NUMBERS
    """How many numbers the rule may have at most, PS(0) counted."""
    rounds: int = 2
    """Rounds of collecting and fitting; the policy drives the first, rules the others."""
    episodes: int = 96
    """Episodes of each round."""
    validation_seeds: int = 64
    """Episodes per scenario that the best few rules are compared by; the others, by a quarter of them."""
    report_seeds: int = 100
    """Episodes per scenario, of other seeds, that policy and rule are compared by at the end."""
    seed: int = 0
    """Seed of the episodes that are collected."""


class Score(NamedTuple):
    """How a controller does on average over scenarios and seeds."""

    mean_return: float
    mean_gap: float  # NaN where an optimum is unknown
    mean_evaluations: float


class Candidate(NamedTuple):
    """A rule on the way.

    Attributes:
        round: that it was fitted in, from 0.
        rule: itself.
        errors: root mean squared error of each decision by name, on episodes that were left out, relative to
            the range of the decision (in the logarithm, but for phi).
        score: as a controller on some validation seeds.
    """

    round: int
    rule: DistilledRule
    errors: dict[str, float]
    score: Score


class Distillation(NamedTuple):
    """A rule, and what it was chosen among."""

    chosen: Candidate
    candidates: list[Candidate]

    @property
    def rule(self) -> DistilledRule:
        """The one that was chosen."""
        return self.chosen.rule


def distil(policy: Controller, training: TrainConfig, config: DistilConfig) -> Distillation:
    """The rule for a policy on the scenarios of its training.

    All rules are compared on a quarter of the validation seeds, and the best few of these on all.
    """
    if config.numbers > MOST_NUMBERS:
        raise ValueError(f"--numbers must be at most {MOST_NUMBERS}, got {config.numbers}")
    if config.rounds < 1:
        raise ValueError(f"--rounds must be at least 1, got {config.rounds}")
    few = VALIDATION[: max(1, config.validation_seeds // SCREENING)]
    driver = policy
    collected: list[Collected] = []
    candidates: list[Candidate] = []
    for number in range(config.rounds):
        collected.append(_collect(driver, policy, training, config, number))
        most = int(RUNAWAY * collected[0].evaluations.max())
        together = Collected(*(np.concatenate(parts) for parts in zip(*collected, strict=True)))
        fitted = []
        for inputs in FAMILIES:
            for rule, errors in _fit_rules(together, inputs, policy, training, config.numbers):
                score = assess(rule, training, few, policy.price, most)
                fitted.append(Candidate(number, rule, errors, score))
                print(f"round {number}, {rule.num_numbers} numbers: {describe(score)}", flush=True)
        driver = max(fitted, key=_mean_return).rule
        candidates += fitted
    finalists = sorted(candidates, key=_mean_return, reverse=True)[:FINALISTS]
    seeds = VALIDATION[: config.validation_seeds]
    compared = [c._replace(score=assess(c.rule, training, seeds, policy.price)) for c in finalists]
    return Distillation(max(compared, key=_mean_return), candidates)


def assess(
    controller: Controller,
    training: TrainConfig,
    seeds: range,
    price: float | None = None,
    most_evaluations: int | None = None,
) -> Score:
    """How a controller does on the validation scenarios of a training, with its reward.

    Args:
        controller: what is assessed.
        training: says the scenarios, the optimizer, sizes and the reward.
        seeds: one episode each, per scenario.
        price: of evaluations, where it is not the training's.
        most_evaluations: a controller that has no budget itself is stopped there.
    """
    options = _options(training, price)
    options["max_evaluations"] = options["max_evaluations"] or most_evaluations
    found = [
        watch(controller, [], [scenario], seeds, optimizer=training.optimizer, **options)
        for scenario in training.validation_scenarios or training.scenarios
    ]
    return Score(
        *(float(np.mean([getattr(f, name) for f in found])) for name in ("returns", "gap", "evaluations"))
    )


def describe(score: Score) -> str:
    """A score as text."""
    return (
        f"return {score.mean_return:.3f}, gap {100 * score.mean_gap:.2f} % at "
        f"{score.mean_evaluations:,.0f} evaluations"
    )


def _mean_return(candidate: Candidate) -> float:
    return candidate.score.mean_return


class Collected(NamedTuple):
    """N states of episodes.

    Attributes:
        inputs: (N, number of inputs) in the order of `INPUTS`.
        decided: (N, d) decisions of the policy, all but phi in the logarithm.
        episodes: (N,) which episode each is of.
        evaluations: (number of episodes,) calls of the cost function.
    """

    inputs: Floats
    decided: Floats
    episodes: NDArray[np.int64]
    evaluations: Floats


def _collect(
    driver: Controller, policy: Controller, training: TrainConfig, config: DistilConfig, number: int
) -> Collected:
    """The states that `driver` visits, with the decisions of the policy."""
    start = training_seed(config.seed, number)
    watched = watch(
        driver, [policy], training.scenarios, range(start, start + config.episodes), OBSERVATION,
        training.optimizer, **_options(training, policy.price),
    )  # fmt: skip
    rows = watched.running
    episodes = np.broadcast_to(np.arange(config.episodes), rows.shape)[rows] + number * config.episodes
    seen, decided = watched.seen[rows], watched.decided[0][rows]
    names = decision_names(policy, training.optimizer)
    columns = [c if name == LINEAR else np.log(c) for name, c in zip(names, decided.T, strict=True)]
    return Collected(
        np.stack([read(seen) for read in INPUTS.values()], axis=1),
        np.stack(columns, axis=1),
        episodes,
        watched.evaluations,
    )


def _fit_rules(
    collected: Collected, inputs: Sequence[str], policy: Controller, training: TrainConfig, numbers: int
) -> Iterator[tuple[DistilledRule, dict[str, float]]]:
    """Rules that use some of these inputs, with ever more numbers, and their errors."""
    names = decision_names(policy, training.optimizer)
    bounds = [_scaled_bounds(name, training) for name in names]
    part = collected.inputs[:, [list(INPUTS).index(name) for name in inputs]]
    paths = []
    for column, (low, high) in zip(collected.decided.T, bounds, strict=True):
        scaled = np.clip((column - low) / (high - low), 0.0, 1.0)
        paths.append(select_forward(part, scaled, 0.0, 1.0, collected.episodes, numbers))
    for fits in share_out(paths, numbers - 1):  # one is PS(0)
        formulas = []
        for name, (low, high), fit in zip(names, bounds, fits, strict=True):
            constant, *weights = (float(c) for c in (high - low) * fit.coefficients)
            used = [inputs[column] for column in fit.inputs]
            formulas.append(Formula(name, low + constant, dict(zip(used, weights, strict=True))))
        rule = DistilledRule(
            policy.initial_population_size, formulas, training.optimizer, policy.max_evaluations,
            training.limits,
        )  # fmt: skip
        yield rule, {name: fit.error for name, fit in zip(names, fits, strict=True)}


def _scaled_bounds(name: str, training: TrainConfig) -> tuple[float, float]:
    """Bounds of a decision, in the logarithm but for phi."""
    low, high = decision_bounds(training.limits, training.optimizer)[name]
    return (low, high) if name == LINEAR else (float(np.log(low)), float(np.log(high)))


def _options(training: TrainConfig, price: float | None) -> dict[str, Any]:
    options = training.env_options()
    return options if price is None else {**options, "price": price}


def main() -> None:
    """Distil as the command line says."""
    config = tyro.cli(DistilConfig, description=__doc__)
    with command():
        policy = make_controller(config.policy)
        manifest = getattr(policy, "manifest", {})
        training = stored_config(manifest)
        found = distil(policy, training, config)
        seeds = ANALYSIS[: config.report_seeds]
        rivals = {config.policy: policy, "rule": found.rule, RIVAL: make_controller(RIVAL, training.limits)}
        scores = {name: assess(one, training, seeds, policy.price) for name, one in rivals.items()}
        save_rule(
            config.output,
            found.rule,
            training.limits,
            {
                "policy": config.policy,
                "weights_sha256": manifest.get("weights_sha256"),
                "config": {
                    "numbers": config.numbers, "rounds": config.rounds, "episodes": config.episodes,
                    "validation_seeds": config.validation_seeds, "seed": config.seed,
                },
                "errors": found.chosen.errors,
                "seeds": [seeds.start, seeds.stop],
                "scores": {name: score._asdict() for name, score in scores.items()},
                "provenance": provenance("numba", "numpy"),
            },
        )  # fmt: skip
    print("\n".join([f"\n{found.rule.num_numbers} numbers:", *found.rule.lines(), ""]))
    for name, score in scores.items():
        print(f"{name}: {describe(score)}")
    print(f"use it as controller distilled:{config.output}")


if __name__ == "__main__":
    main()

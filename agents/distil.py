"""Distil a trained policy into a rule of at most ten numbers: `python -m agents.distil --help`.

The policy's decisions are collected over episodes of its training scenarios, together with inputs that a
person can read (`swarm_gym.controllers.distilled.INPUTS`). Each decision is fitted by a weighted sum of a
few of them. A rule leads to states that the policy does not visit. In further rounds, the policy therefore
decides in the states that the last rule visits, and rules are fitted to all rounds together. The result is
the rule with the highest mean return on validation seeds, among rules of all rounds and lengths.

Source of the further rounds: S. Ross et al., "A reduction of imitation learning and structured prediction to
no-regret online learning", AISTATS 2011.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, NamedTuple

import numpy as np
import tyro
from numpy.typing import NDArray

from agents.evaluation.observers import decision_names, watch
from agents.rule_fit import select_forward, share_out
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
from swarm_gym.controllers.names import ControllerName
from swarm_gym.outputs import files_named, require_outputs
from swarm_gym.runs.provenance import provenance
from swarm_gym.runs.seeds import ANALYSIS, VALIDATION, training_seed
from swarm_gym.training.config import EnvOptions, TrainConfig, stored_config

Floats = NDArray[np.float64]

RIVAL = "spsfa-tip"  # reported beside the policy and its rule
SCREENING = 4  # all rules are compared on this fraction of the validation seeds, 1 / SCREENING
FINALISTS = 4  # number of best rules that are compared on all validation seeds
RUNAWAY = 3.0  # while screening, episodes end at this multiple of the policy's most evaluations
# A rule with the current size as input changes the size; a rule without it sets the size.
FAMILIES = (tuple(INPUTS), tuple(name for name in INPUTS if name != CURRENT_SIZE))


@dataclass(frozen=True)
class DistilConfig:
    """Options of a distillation; all are stored with the rule."""

    policy: Annotated[str, tyro.conf.Positional]
    """Controller to distil, e.g. learned:three-cases/0@1 or learned:runs/mine/0/best.safetensors."""
    output: Path
    """File to write, e.g. runs/rule.json; a file in data/distilled of a study is found by name."""
    numbers: int = MOST_NUMBERS
    """Largest number of fitted numbers in the rule, PS(0) included; at most 10."""
    rounds: int = 2
    """Rounds of collecting and fitting; the policy acts in the first round, the last rule in others."""
    episodes: int = 96
    """Episodes of each round."""
    validation_seeds: int = 64
    """Episodes per scenario to compare the best rules by; the other rules have a quarter of them."""
    report_seeds: int = 100
    """Episodes per scenario, with other seeds, to compare the policy and its rule at the end."""
    seed: int = 0
    """Seed of the collected episodes."""


class Score(NamedTuple):
    """Mean results of a controller over scenarios and seeds.

    Attributes:
        mean_return: mean sum of rewards.
        mean_gap: mean final optimality gap; NaN if an optimum is unknown.
        mean_evaluations: mean number of calls of the cost function.
    """

    mean_return: float
    mean_gap: float
    mean_evaluations: float

    def stored(self) -> dict[str, float | None]:
        """Return the results by name for a file of JSON, which has no NaN; an unknown one is None."""
        return {name: None if math.isnan(value) else value for name, value in self._asdict().items()}


class Candidate(NamedTuple):
    """A fitted rule.

    Attributes:
        round: round of the fit, from 0.
        rule: the rule.
        errors: root mean squared error of each decision by name, on episodes that were left out, relative to
            the range of the decision (in the logarithm, but for phi).
        score: results as a controller on some validation seeds.
    """

    round: int
    rule: DistilledRule
    errors: dict[str, float]
    score: Score


class Distillation(NamedTuple):
    """The result of a distillation.

    Attributes:
        chosen: best candidate.
        candidates: all candidates.
    """

    chosen: Candidate
    candidates: list[Candidate]

    @property
    def rule(self) -> DistilledRule:
        """The best rule."""
        return self.chosen.rule


def run_distillation(config: DistilConfig) -> tuple[DistilledRule, dict[str, Score]]:
    """Distil a policy, compare it with its rule on seeds that nothing was chosen by, and write the rule.

    Returns:
        The rule, and scores of the policy, the rule and the controller `RIVAL` by name.
    """
    require_outputs([config.output], files_named(config.policy))
    policy = make_controller(config.policy)
    manifest = getattr(policy, "manifest", {})
    if not manifest.get("config"):
        raise ValueError(
            f"policy {config.policy!r}: its training is unknown, whose scenarios and options episodes need; "
            "expected learned:<policy> of a policy that agents.train has made"
        )
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
            "scores": {name: score.stored() for name, score in scores.items()},
            "provenance": provenance("numba", "numpy"),
        },
    )  # fmt: skip
    return found.rule, scores


def distil(policy: Controller, training: TrainConfig, config: DistilConfig) -> Distillation:
    """Return the best rule for a policy on the scenarios of its training, and all candidates.

    All rules are compared on a quarter of the validation seeds, and the best few of them on all seeds.

    Raises:
        ValueError: for too many numbers or too few rounds, or for a decision that no rule can have.
    """
    if config.numbers > MOST_NUMBERS:
        raise ValueError(f"--numbers must be at most {MOST_NUMBERS}, got {config.numbers}")
    if config.rounds < 1:
        raise ValueError(f"--rounds must be at least 1, got {config.rounds}")
    possible = decision_bounds(training.limits, training.optimizer)
    if others := [name for name in decision_names(policy, training.optimizer) if name not in possible]:
        raise ValueError(
            f"policy {config.policy!r} decides {', '.join(others)}, which a rule cannot; expected a policy "
            f"of {', '.join(possible)}"
        )
    few = VALIDATION[: max(1, config.validation_seeds // SCREENING)]
    controller = policy
    collected: list[Collected] = []
    candidates: list[Candidate] = []
    for number in range(config.rounds):
        collected.append(_collect(controller, policy, training, config, number))
        most = int(RUNAWAY * collected[0].evaluations.max())
        together = Collected(*(np.concatenate(parts) for parts in zip(*collected, strict=True)))
        fitted = []
        for inputs in FAMILIES:
            for rule, errors in _fit_rules(together, inputs, policy, training, config.numbers):
                score = assess(rule, training, few, policy.price, most)
                fitted.append(Candidate(number, rule, errors, score))
                print(f"round {number}, {rule.num_numbers} numbers: {describe(score)}", flush=True)
        controller = max(fitted, key=_mean_return).rule
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
    """Return mean results of a controller on the validation scenarios of a training, with its reward.

    Args:
        controller: controller to assess.
        training: configuration with the scenarios, optimizer, population sizes and reward.
        seeds: one episode per seed and scenario.
        price: price of 100,000 evaluations; None is the training's.
        most_evaluations: number of evaluations after which an episode without a budget ends.
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
    """Return a score as text, with the gap if it is known."""
    gap = "" if math.isnan(score.mean_gap) else f", gap {100 * score.mean_gap:.2f} %"
    return f"return {score.mean_return:.3f}{gap} at {score.mean_evaluations:,.0f} evaluations"


def _mean_return(candidate: Candidate) -> float:
    return candidate.score.mean_return


class Collected(NamedTuple):
    """N states of episodes, with the decisions of a policy.

    Attributes:
        inputs: (N, number of inputs) inputs in the order of `INPUTS`.
        decided: (N, d) decisions of the policy, all but phi in the logarithm.
        episodes: (N,) number of the episode of each state.
        evaluations: (number of episodes,) number of calls of the cost function.
    """

    inputs: Floats
    decided: Floats
    episodes: NDArray[np.int64]
    evaluations: Floats


def _collect(
    controller: Controller, policy: Controller, training: TrainConfig, config: DistilConfig, number: int
) -> Collected:
    """Return the states that a controller visits in round `number`, with the decisions of the policy."""
    start = training_seed(config.seed, number)
    watched = watch(
        controller, [policy], training.scenarios, range(start, start + config.episodes), OBSERVATION,
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
    """Yield rules with more and more of these inputs, and their errors by decision."""
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
            training.limits, policy.first_source,
        )  # fmt: skip
        yield rule, {name: fit.error for name, fit in zip(names, fits, strict=True)}


def _scaled_bounds(name: str, training: TrainConfig) -> tuple[float, float]:
    """Return the bounds of a decision, in the logarithm but for phi."""
    low, high = decision_bounds(training.limits, training.optimizer)[name]
    return (low, high) if name == LINEAR else (float(np.log(low)), float(np.log(high)))


def _options(training: TrainConfig, price: float | None) -> EnvOptions:
    options = training.env_options()
    return options if price is None else {**options, "price": price}


def main() -> None:
    """Distil a policy with the options of the command line."""
    config = tyro.cli(DistilConfig, description=__doc__)
    with command():
        rule, scores = run_distillation(config)
    print("\n".join([f"\n{rule.num_numbers} numbers:", *rule.lines(), ""]))
    for name, score in scores.items():
        print(f"{name}: {describe(score)}")
    print(f"use it as controller {ControllerName.of('distilled', str(config.output))}")


if __name__ == "__main__":
    main()

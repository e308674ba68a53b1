"""Trainings of plain learners: the course of validation, and episodes on test seeds at the end."""

import json
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
import torch
from stable_baselines3.common.base_class import BaseAlgorithm
from stable_baselines3.common.callbacks import BaseCallback

from experiments.studies.controllers import CASES
from experiments.studies.learners.recipes import ALGORITHMS, NUM_SWARMS, RECIPES, Recipe
from swarm_gym.files import write_atomically
from swarm_gym.runs.provenance import provenance
from swarm_gym.runs.seeds import TEST, TRAINING_START, VALIDATION

TEST_SEEDS = TEST[61_000:61_100]  # of every case; used by no other study
VALIDATION_SEEDS = VALIDATION[20_000:20_020]
SEEDS_APART = 1_000_000  # between the first training seeds of two trainings
VALIDATE_EVERY = 20_000  # environment steps


@dataclass(frozen=True)
class Outcome:
    """Episodes of a policy on the cases.

    Attributes:
        gaps: optimality gaps by case and seed, shares.
        evaluations: evaluations by case and seed.
    """

    gaps: list[list[float]]
    evaluations: list[list[float]]

    @property
    def objective(self) -> float:
        """Mean gap in per cent plus evaluations / 100,000, the objective at price 1."""
        return float(100.0 * np.mean(self.gaps) + np.mean(self.evaluations) / 100_000.0)


@dataclass(frozen=True)
class Training:
    """A finished training.

    Attributes:
        recipe: name of the recipe.
        seed: training seed.
        steps: environment steps of the training.
        course: objective on validation seeds after so many steps, by steps.
        outcome: episodes of the last policy on test seeds.
    """

    recipe: str
    seed: int
    steps: int
    course: dict[int, float]
    outcome: Outcome


def training_file(folder: Path, recipe: str, steps: int, seed: int) -> Path:
    """Return the file that a training is stored in."""
    return folder / f"{recipe}-{steps}" / f"{seed}.json"


def train(name: str, seed: int, steps: int, folder: Path, report: Callable[[int], None]) -> Path:
    """Train a recipe, and store the training and its model.

    A training that is stored is left as it is. If its last policy was tested on other seeds than
    `TEST_SEEDS`, it is tested again.

    Args:
        name: a key of `RECIPES`.
        seed: training seed.
        steps: environment steps.
        folder: folder of all trainings.
        report: function that is called with the number of steps so far.
    """
    file = training_file(folder, name, steps, seed)
    torch.set_num_threads(1)
    recipe = RECIPES[name]
    if file.exists():
        given = json.loads(file.read_text(encoding="utf-8"))
        if given.get("test_seeds") == _test_seeds():
            return file
        last = ALGORITHMS[recipe.algorithm].load(file.with_suffix(".zip"), device="cpu")
        return _write(file, {**given, "outcome": asdict(run(recipe, last, TEST_SEEDS))})
    first = TRAINING_START + SEEDS_APART * (seed + 1)
    model = recipe.model(recipe.swarms(NUM_SWARMS, first), seed)
    course: dict[int, float] = {}

    def validate() -> None:
        course[model.num_timesteps] = run(recipe, model, VALIDATION_SEEDS).objective

    model.learn(steps, callback=_Watching(validate, report))
    outcome = run(recipe, model, TEST_SEEDS)
    file.parent.mkdir(parents=True, exist_ok=True)
    model.save(file.with_suffix(".zip"))
    done = asdict(Training(name, seed, steps, course, outcome))
    return _write(file, {**done, "provenance": provenance("numpy", "torch")})


def _write(file: Path, training: Mapping[str, object]) -> Path:
    """Write a training with the seeds that its last policy was tested on."""
    return write_atomically(file, json.dumps({**training, "test_seeds": _test_seeds()}) + "\n")


def _test_seeds() -> list[int]:
    return [TEST_SEEDS.start, TEST_SEEDS.stop]


def stored(folder: Path, recipe: str, steps: int) -> list[Training]:
    """Return the trainings of a recipe that are stored, by seed."""
    found = []
    files = training_file(folder, recipe, steps, 0).parent.glob("*.json")
    for file in sorted(files, key=lambda one: int(one.stem)):
        given: dict[str, Any] = json.loads(file.read_text(encoding="utf-8"))
        course = {int(step): objective for step, objective in given["course"].items()}
        found.append(
            Training(given["recipe"], given["seed"], given["steps"], course, Outcome(**given["outcome"]))
        )
    return found


def run(recipe: Recipe, model: BaseAlgorithm, seeds: range) -> Outcome:
    """Run a policy without noise on every case with these seeds."""
    found = [_run_case(recipe, model, case, seeds) for case in CASES]
    return Outcome([gaps for gaps, _ in found], [evaluations for _, evaluations in found])


def _run_case(
    recipe: Recipe, model: BaseAlgorithm, case: str, seeds: range
) -> tuple[list[float], list[float]]:
    """Return the gaps and evaluations of an episode of each seed."""
    swarms = recipe.swarms(len(seeds), seeds.start, case)
    seen: Any = swarms.reset()
    state, begins = None, np.ones(len(seeds), dtype=np.bool_)
    ended: list[dict[str, Any]] = [{} for _ in seeds]
    while not all(ended):
        actions, state = model.predict(seen, state=state, episode_start=begins, deterministic=True)
        seen, _, begins, infos = swarms.step(actions)
        ended = [before or now for before, now in zip(ended, infos, strict=True)]
    swarms.close()
    return [one["optimality_gap"] for one in ended], [float(one["evaluations"]) for one in ended]


class _Watching(BaseCallback):
    """Validates every `VALIDATE_EVERY` steps, before the first step and after the last one."""

    def __init__(self, validate: Callable[[], None], report: Callable[[int], None]):
        super().__init__()
        self._validate, self._report, self._next = validate, report, 0

    def _on_step(self) -> bool:
        if self.num_timesteps >= self._next:
            self._validate()
            self._next += VALIDATE_EVERY
        self._report(self.num_timesteps)
        return True

    def _on_training_end(self) -> None:
        self._validate()

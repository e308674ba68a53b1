"""Tables of what plain learners reach, beside controllers that learn nothing and this project's trainings."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from experiments.runs.labels import label
from experiments.statistics import Draws, draw, interval, mean_difference, means
from experiments.studies.controllers import CASES
from experiments.studies.learners.recipes import RECIPES
from experiments.studies.learners.trainings import TEST_SEEDS, stored
from experiments.tables.cell import MISSING, Cell, Entry, gap_at_cost, number, number_in
from experiments.tables.table import Row, Table
from swarm_gym.comparing.compared_runs import optima_of
from swarm_gym.controllers import make_controller
from swarm_gym.reference import gap_to_optimum
from swarm_gym.rollout import run_episodes

Floats = NDArray[np.float64]

PAPER, TUNED = "spsfa-tip", "open-loop:three-cases"  # differences are to these
RIVALS: Mapping[str, tuple[str, ...]] = {
    **{label(name): (name,) for name in ("fixed:30", "fixed:60", "fixed:100", PAPER)},
    "open loop three-cases": (TUNED,),
    "open loop three-cases-sourced": ("open-loop:three-cases-sourced/0@1",),
    "this project's PPO, three-cases@1": tuple(f"learned:three-cases/{seed}@1" for seed in range(10)),
}
CAPTION = (
    "Objective: mean gap in per cent of the optimum plus evaluations / 100,000, over {seeds} test seeds of "
    "each case and all training seeds, {trained} of each recipe [95 % interval]. By case: mean gap in per "
    "cent at mean evaluations. Minus: difference of the objectives to SPSFA-TIP, to a schedule tuned for "
    "these cases, and to the controller that a residual policy corrects"
)


@dataclass(frozen=True)
class LearnerSample:
    """Episodes of controllers that differ in their training seed only.

    Attributes:
        gaps: (training seeds, cases, seeds) optimality gaps, shares.
        evaluations: (training seeds, cases, seeds) evaluations.
    """

    gaps: Floats
    evaluations: Floats

    @property
    def objective(self) -> Floats:
        """Objectives at price 1, shaped like `gaps`."""
        return 100.0 * self.gaps + self.evaluations / 100_000.0

    def draws(self, stream: int = 0) -> Draws:
        """Return the draws of bootstrap resamples; samples that are compared need different streams."""
        return draw(len(self.gaps), (1,) * len(CASES), self.gaps.shape[2], stream)

    def minus(self, other: "LearnerSample") -> Cell:
        """Return the difference of the objectives with its interval."""
        draws = self.draws(), other.draws(1)
        return number_in(*mean_difference(self.objective, other.objective, *draws), "+.2f")

    def cells(self) -> dict[str, Entry]:
        """Return the entries of a row that need no other sample."""
        objective = self.objective
        gaps, evaluations = self.gaps.mean(axis=(0, 2)), self.evaluations.mean(axis=(0, 2))
        return {
            "seeds": number(len(self.gaps), "d"),
            "objective": number_in(objective.mean(), interval(means(objective, self.draws())), ".2f"),
            **{case: gap_at_cost(gaps[k], evaluations[k]) for k, case in enumerate(CASES)},
        }


def rivals() -> dict[str, LearnerSample]:
    """Run the rivals on the test seeds, and return their samples by the names of their rows."""
    found = {}
    for row, names in RIVALS.items():
        runs = [[run_episodes(make_controller(name), case, TEST_SEEDS) for case in CASES] for name in names]
        fitness = np.array([[one.final_fitness for one in cases] for cases in runs])
        evaluations = np.array([[one.evaluations for one in cases] for cases in runs])
        found[row] = LearnerSample(gap_to_optimum(fitness, optima_of(CASES, {})[:, None]), evaluations)
    return found


def learned(folder: Path, steps: int) -> dict[str, LearnerSample]:
    """Return the samples of all recipes that have trainings of so many steps, by the names of recipes."""
    found = {}
    for name in RECIPES:
        trainings = stored(folder, name, steps)
        if trainings:
            gaps = np.array([one.outcome.gaps for one in trainings])
            found[name] = LearnerSample(gaps, np.array([one.outcome.evaluations for one in trainings]))
    return found


def reached(samples: Mapping[str, LearnerSample], beside: Mapping[str, LearnerSample], steps: int) -> Table:
    """Return the table of all learners and rivals, ordered by their objective."""
    paper, tuned = beside[label(PAPER)], beside["open loop three-cases"]
    rows_of_bases = {names[0]: row for row, names in RIVALS.items()}
    rows: list[tuple[float, Row]] = []
    for name, sample in {**samples, **beside}.items():
        recipe = RECIPES.get(name)
        base = None if recipe is None else recipe.env.get("base")
        row: Row = {
            "learner or controller": name if recipe is None else f"{recipe.algorithm} (`{name}`)",
            "learns": MISSING if recipe is None else recipe.kind,
            **sample.cells(),
            "minus SPSFA-TIP": MISSING if sample is paper else sample.minus(paper),
            "minus open loop three-cases": MISSING if sample is tuned else sample.minus(tuned),
            "minus its base": MISSING if base is None else sample.minus(beside[rows_of_bases[base]]),
        }
        rows.append((float(sample.objective.mean()), row))
    trained = " or ".join(map(str, sorted({len(sample.gaps) for sample in samples.values()})))
    words = CAPTION.format(seeds=len(TEST_SEEDS), trained=trained)
    caption = f"After {steps:,} environment steps. {words}"
    ordered = [row for _, row in sorted(rows, key=lambda pair: pair[0])]
    return Table.of(f"reached-{steps}", caption, ordered)


def options_table() -> Table:
    """Return the table of recipes: what differs from the library and from `make_vec`."""
    rows: list[Row] = [
        {
            "recipe": f"`{name}`",
            "algorithm": recipe.algorithm,
            "options that differ from the library's": _listed(recipe.options),
            "options that differ from those of make_vec": _listed(recipe.env),
            "rewards": "scaled by `VecNormalize`" if recipe.scales_rewards else "as they are",
        }
        for name, recipe in RECIPES.items()
    ]
    return Table.of("recipes", "Recipes of the learners", rows)


def _listed(options: Mapping[str, object]) -> str:
    return ", ".join(f"`{name}={value!r}`" for name, value in options.items()) or "none"

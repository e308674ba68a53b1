"""Gaps of this study's rows on test functions, in files that a later call goes on from."""

import json
import time
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray
from tqdm import tqdm

from experiments.studies.controllers import with_budget
from experiments.studies.strong.entrants import Entrant, controller_of
from experiments.studies.strong.grounds import METABOX, Ground
from experiments.studies.strong.published import EVALUATIONS
from swarm_gym.controllers import SizeLimits
from swarm_gym.controllers.controller import Controller
from swarm_gym.files import write_atomically
from swarm_gym.rollout import Episodes, run_episodes
from swarm_gym.runs.provenance import provenance
from swarm_gym.runs.seeds import TEST

Floats = NDArray[np.float64]


class Measured(NamedTuple):
    """Gaps of the runs of a row; both arrays are (training seeds, functions, runs).

    Attributes:
        final: gaps after all evaluations.
        anytime: means of log10 of the gap, at least 1e-8, over all evaluations.
    """

    final: Floats
    anytime: Floats


Arrays = TypeVar("Arrays", bound=NamedTuple)  # a named tuple of arrays


def measure(entrant: Entrant, num_runs: int, folder: Path, ground: Ground = METABOX) -> Measured:
    """Return the gaps of a row; what is in the folder is not run again, and the rest is written there.

    Args:
        entrant: the row.
        num_runs: number of runs of each training seed on each function.
        folder: folder of the files, one for each controller.
        ground: the functions.
    """
    parts = [
        _measure_one(entrant, controller, num_runs, folder, ground) for controller in entrant.controllers
    ]
    return Measured(np.stack([part.final for part in parts]), np.stack([part.anytime for part in parts]))


def measure_all(
    entrants: Iterable[Entrant], num_runs: int, folder: Path, ground: Ground = METABOX
) -> dict[str, Measured]:
    """Return the gaps of all rows by their names."""
    bar = tqdm([*entrants], desc=f"rows {ground.name}".rstrip(), unit="row")
    return {entrant.name: measure(entrant, num_runs, folder, ground) for entrant in bar}


def _measure_one(entrant: Entrant, controller: str, num_runs: int, folder: Path, ground: Ground) -> Measured:
    """Return the gaps of one controller, arrays (functions, runs)."""
    made = with_budget(controller_of(entrant, controller), ground.evaluations)
    asked: dict[str, object] = {
        "optimizer": entrant.optimizer,
        "controller": controller,
        "identity": repr(made.identity()),
        "iterations": _iterations(entrant, ground.evaluations),
        "runs": num_runs,
    }
    if ground.name:
        asked |= {"scenarios": [*ground.scenarios], "evaluations": ground.evaluations}
    if ground.first_seed:
        asked["first seed"] = ground.first_seed
    name = file_name(ground.name, entrant.optimizer, controller, str(num_runs))

    def run() -> Measured:
        seeds = TEST[ground.first_seed : ground.first_seed + num_runs]
        found = [run_row(entrant, made, scenario, seeds, ground.evaluations) for scenario in ground.scenarios]
        return Measured(
            np.stack([episodes.final_fitness for episodes in found]),
            -np.stack([episodes.returns for episodes in found]),
        )

    return kept(folder / name, asked, Measured, run)


def file_name(*parts: str) -> str:
    """Return the name of a file of what these words name; empty ones are left out."""
    return "".join(letter if letter.isalnum() else "-" for letter in "-".join(filter(None, parts))) + ".json"


def kept(file: Path, asked: Mapping[str, object], kind: type[Arrays], run: Callable[[], Arrays]) -> Arrays:
    """Return arrays from a file if it was made for the same; else make and write them.

    Args:
        file: the file.
        asked: settings that decide the arrays, of types that JSON has.
        kind: named tuple of arrays.
        run: function that makes them.
    """
    if file.is_file():
        stored = json.loads(file.read_text(encoding="utf-8"))
        if stored["asked"] == asked:
            return kind._make(np.array(stored[name]) for name in kind._fields)
    arrays = run()
    lists = {name: part.tolist() for name, part in arrays._asdict().items()}
    file.parent.mkdir(parents=True, exist_ok=True)
    write_atomically(file, json.dumps({"asked": asked, **lists, "provenance": provenance()}) + "\n")
    return arrays


def _iterations(row: Entrant, evaluations: int) -> int:
    """Return the iterations of a row, in proportion to the budget."""
    return row.iterations * evaluations // EVALUATIONS


def run_row(row: Entrant, controller: Controller, scenario: str, seeds: range, evaluations: int) -> Episodes:
    """Return runs of a row on one function, with the reward that is paid for the gap over the budget."""
    return run_episodes(
        controller,
        scenario,
        seeds,
        row.optimizer,
        iterations=_iterations(row, evaluations),
        max_evaluations=evaluations,
        reward="anytime",
        # The limits of a policy are in its file, and come before these.
        max_population_size=(row.limits or SizeLimits()).largest,
    )


def timed_runs(row: Entrant, scenario: str, num_runs: int, evaluations: int) -> tuple[Floats, float]:
    """Return gaps of runs by the first controller of a row, and evaluations in a second of processor time."""
    controller = controller_of(row, row.controllers[0])
    before = time.process_time()
    episodes = run_row(row, controller, scenario, TEST[:num_runs], evaluations)
    return episodes.final_fitness, float(episodes.evaluations.sum() / (time.process_time() - before))

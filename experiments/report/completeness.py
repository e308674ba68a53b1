"""The part of a suite that a database holds completely, so that all comparisons of a report are paired."""

import dataclasses
import math
from collections.abc import Mapping
from itertools import count

from experiments.runs.database import Results
from experiments.runs.entries import is_aside
from experiments.runs.labels import label
from experiments.runs.suite import Suite
from swarm_gym.controllers import CONTROLLERS
from swarm_gym.controllers.names import BLINDED, ControllerName
from swarm_gym.optimizers import OPTIMIZERS
from swarm_gym.own_code import refuse_unless_given

# A controller with less than this share of the most seeds of any pair is left out; others would lose seeds.
LEAST_SHARE = 0.5
MOST_NAMED = 12  # names in a notice

Counts = dict[tuple[str, str], int]  # number of runs by controller and scenario


def refuse_own_code(results: Results, suite: Suite) -> None:
    """Raise an error if a database has runs of controllers of own code that the user did not name.

    Raises:
        OwnCodeError: with the name.
    """
    for name in _present(results.finished()).difference(suite.controllers):
        parts = ControllerName.parse(name)
        if parts.optimizer not in (None, *OPTIMIZERS):
            refuse_unless_given("optimizer", parts.optimizer, f"{results.path}: {name}")
        if parts.family not in (*CONTROLLERS, BLINDED):
            refuse_unless_given("controller", str(parts.controller), str(results.path))


def complete_part(suite: Suite, results: Results) -> tuple[Suite | None, list[str]]:
    """Return the largest part of a suite of which no run is missing, with all controllers that are stored.

    Suites run seed by seed, so that the first seeds of a stopped suite are complete. Controllers with few
    runs, and scenarios that some controllers lack, are left out.

    Returns:
        The part, or None if too few runs are stored, and sentences that say what is left out, and why.
    """
    stored = results.finished()
    if not stored:
        return None, ["The database holds no runs yet."]
    present = _present(stored)
    controllers = [name for name in suite.controllers if name in present]
    controllers += sorted(present.difference(controllers))
    counts = _leading_seeds(suite, stored)
    most = max(counts.values(), default=0)
    least = max(min(2, suite.num_seeds), math.ceil(LEAST_SHARE * most))
    kept = [name for name in controllers if any(counts.get((name, s), 0) >= least for s in suite.scenarios)]
    while kept and not (scenarios := _complete_scenarios(suite, kept, counts, least)):
        kept.remove(min(kept, key=lambda name: sum(counts.get((name, s), 0) for s in suite.scenarios)))
    if not kept:
        few = f"at most {most} seeds of a controller on a scenario, {suite.num_seeds} are asked for"
        return None, [f"The database holds {len(stored)} runs, but too few to compare: {few}."]
    num_seeds = min(counts[name, scenario] for name in kept for scenario in scenarios)
    part = dataclasses.replace(
        suite,
        controllers=tuple(kept),
        scenarios=tuple(scenarios),
        num_seeds=num_seeds,
        snapshots=(),
        families=tuple(family for family in suite.families if set(family.controllers) <= set(kept)),
    )
    return part, _notices(part, suite, controllers, counts, len(stored))


def _present(stored: set[tuple[str, str, int]]) -> set[str]:
    """Return the controllers that runs are stored of, without entries that were kept aside."""
    return {controller for controller, _, _ in stored if not is_aside(controller)}


def _leading_seeds(suite: Suite, stored: set[tuple[str, str, int]]) -> Counts:
    """Return the number of seeds of each controller on each scenario, from the first one on without gaps."""
    firsts = {name: seeds.start for name, seeds in suite.seeds.items()}
    by_pair: dict[tuple[str, str], set[int]] = {}
    for controller, scenario, seed in stored:
        if scenario in firsts:
            by_pair.setdefault((controller, scenario), set()).add(seed)
    return {
        (controller, scenario): next(k for k in count() if firsts[scenario] + k not in seeds)
        for (controller, scenario), seeds in by_pair.items()
    }


def _complete_scenarios(
    suite: Suite, controllers: list[str], counts: Mapping[tuple[str, str], int], least: int
) -> list[str]:
    """Return scenarios on which all controllers have enough seeds; the first ones if each has its own."""
    complete = []
    for scenario in suite.scenarios:
        if all(counts.get((name, scenario), 0) >= least for name in controllers):
            complete.append(scenario)
        elif suite.seed_step:
            break  # the seeds of a scenario depend on its position in the suite
    return complete


def _notices(part: Suite, suite: Suite, controllers: list[str], counts: Counts, num_stored: int) -> list[str]:
    """Return sentences about all that the part leaves out."""
    used = len(part.controllers) * len(part.scenarios) * part.num_seeds
    if used == num_stored and part.scenarios == suite.scenarios:
        return []
    found = [f"This database is partial: the report is about {used:,} of its {num_stored:,} runs."]
    for what, everything, kept in (
        ("Controllers", controllers, part.controllers),
        ("Scenarios", suite.scenarios, part.scenarios),
    ):
        lacking = [name for name in everything if name not in kept]
        if lacking:
            names = ", ".join(label(name) for name in lacking[:MOST_NAMED])
            more = f" and {len(lacking) - MOST_NAMED} more" if len(lacking) > MOST_NAMED else ""
            found.append(f"{what} left out because runs are missing: {names}{more}.")
    most = max(counts[name, scenario] for name in part.controllers for scenario in part.scenarios)
    if most > part.num_seeds:
        found.append(f"Every controller has {part.num_seeds} seeds on every scenario; some have {most}.")
    return found

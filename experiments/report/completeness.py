"""Which part of a suite a database holds completely, so that everything in a report is paired."""

import dataclasses
import math
from collections.abc import Mapping
from typing import NamedTuple

from experiments.runs.database import Results
from experiments.runs.labels import label
from experiments.runs.suite import Suite

# Of the most seeds that any pair has: a controller with a smaller share would cost all others their seeds.
LEAST_SHARE = 0.5
MOST_NAMED = 12  # in a notice

Counts = dict[tuple[str, str], int]  # runs by controller and scenario


class Complete(NamedTuple):
    """What a report is about.

    Attributes:
        suite: with the controllers, scenarios and seeds that every run is stored of; None if there are none.
        notices: what is left out, and why, in sentences.
    """

    suite: Suite | None
    notices: list[str]


def complete_part(suite: Suite, results: Results) -> Complete:
    """The largest part of a suite, with whatever controllers are stored, of which no run is missing.

    Suites run seed by seed, so that of one that was stopped the first seeds are complete. Controllers that
    were begun only, and scenarios that some controllers lack, are left out.
    """
    stored = results.finished()
    if not stored:
        return Complete(None, ["The database holds no runs yet."])
    present = {controller for controller, _, _ in stored}
    controllers = [name for name in suite.controllers if name in present]
    controllers += sorted(present.difference(controllers))
    counts = _leading_seeds(suite, stored)
    most = max(counts.values(), default=0)
    least = max(min(2, suite.num_seeds), math.ceil(LEAST_SHARE * most))
    kept = [name for name in controllers if any(counts.get((name, s), 0) >= least for s in suite.scenarios)]
    while kept and not (scenarios := _complete_scenarios(suite, kept, counts, least)):
        kept.remove(min(kept, key=lambda name: sum(counts.get((name, s), 0) for s in suite.scenarios)))
    if not kept:
        return Complete(
            None, [f"The database holds {len(stored)} runs, but too few to compare: {_count(suite, counts)}."]
        )
    num_seeds = min(counts[name, scenario] for name in kept for scenario in scenarios)
    part = dataclasses.replace(
        suite,
        controllers=tuple(kept),
        scenarios=tuple(scenarios),
        num_seeds=num_seeds,
        snapshots=(),
        families=tuple(family for family in suite.families if set(family.controllers) <= set(kept)),
    )
    return Complete(part, _notices(part, suite, controllers, counts, len(stored)))


def _leading_seeds(suite: Suite, stored: set[tuple[str, str, int]]) -> Counts:
    """How many seeds each controller has on each scenario, from the suite's first on without a gap."""
    firsts = {name: seeds.start for name, seeds in suite.seeds.items()}
    by_pair: dict[tuple[str, str], set[int]] = {}
    for controller, scenario, seed in stored:
        if scenario in firsts:
            by_pair.setdefault((controller, scenario), set()).add(seed)
    counts = {}
    for pair, seeds in by_pair.items():
        first = last = firsts[pair[1]]
        while last in seeds:
            last += 1
        counts[pair] = last - first
    return counts


def _complete_scenarios(
    suite: Suite, controllers: list[str], counts: Mapping[tuple[str, str], int], least: int
) -> list[str]:
    """Scenarios that all of the controllers have this many seeds of; the first ones if each has its own."""
    complete = []
    for scenario in suite.scenarios:
        if all(counts.get((name, scenario), 0) >= least for name in controllers):
            complete.append(scenario)
        elif suite.seed_step:
            break  # which seeds a scenario has goes by its place
    return complete


def _notices(part: Suite, suite: Suite, controllers: list[str], counts: Counts, num_stored: int) -> list[str]:
    used = len(part.controllers) * len(part.scenarios) * part.num_seeds
    if used == num_stored and part.scenarios == suite.scenarios:
        return []
    found = [f"This database is partial: the page is about {used:,} of its {num_stored:,} runs."]
    for what, everything, kept in (
        ("controllers", controllers, part.controllers),
        ("scenarios", suite.scenarios, part.scenarios),
    ):
        lacking = [name for name in everything if name not in kept]
        if lacking:
            names = ", ".join(label(name) for name in lacking[:MOST_NAMED])
            more = f" and {len(lacking) - MOST_NAMED} more" if len(lacking) > MOST_NAMED else ""
            found.append(f"Left out since runs are missing, {what}: {names}{more}.")
    most = max(counts[name, scenario] for name in part.controllers for scenario in part.scenarios)
    if most > part.num_seeds:
        found.append(f"Every controller has {part.num_seeds} seeds on every scenario; some have {most}.")
    return found


def _count(suite: Suite, counts: Counts) -> str:
    """How many seeds there are at most."""
    wanted = f"{suite.num_seeds} are asked for"
    return f"at most {max(counts.values(), default=0)} seeds of a controller on a scenario, {wanted}"

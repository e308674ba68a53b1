"""The content of a report: tables, figures, replays, and how they were made."""

import dataclasses
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from tqdm import tqdm

from experiments.documents.suite_page import command_of, describe_provenance, make_tables
from experiments.playground.playground_page import playground_for
from experiments.report.completeness import complete_part
from experiments.report.document import Report, Section
from experiments.report.drawn import DrawnFigure, draw_all
from experiments.report.map_picture import describe_map
from experiments.report.recording import Recording, ReplayError, record
from experiments.report.replay import pack
from experiments.runs.database import Results, ResultsError
from experiments.runs.labels import label
from experiments.runs.outcomes import Outcomes
from experiments.runs.run import RunKey
from experiments.runs.suite import Suite
from experiments.tables import Table
from experiments.tables.cell import number
from swarm_gym.errors import ScenarioError

MOST_RUNS = 3000  # runs that are listed one by one
REPLAYED_SCENARIOS = 3  # first scenarios of a suite, on which runs are replayed by default and swarms steered


# Names of tables and figures of optimality gaps that a report adds to those of its suite.
GAP_TABLES, GAP_FIGURES = ("gaps", "front"), ("profiles", "front")


class Request(NamedTuple):
    """A request for a report.

    Attributes:
        database: file of the results database.
        suite: suite of its runs.
        replays: keys of the runs to replay; None for those that the suite names.
        figures: whether to draw figures.
    """

    database: Path
    suite: Suite
    replays: Sequence[RunKey] | None = None
    figures: bool = True


def make_report(request: Request, results: Results) -> Report:
    """Return the report of a database; runs to replay are run again.

    Raises:
        ResultsError: if a run to replay is not in the database.
    """
    part, notices = complete_part(request.suite, results)
    title = f"swarm_gym: suite {request.suite.name}"
    configuration = results.configuration()
    if part is None:
        if request.replays:
            raise ResultsError(f"{request.database}: no runs to replay; {' '.join(notices)}")
        return Report(title, "There is nothing to show yet.", notices, configuration=configuration)
    made_with = results.provenances(part.controllers, part.seeds)
    if len(made_with) > 1:
        notices.append(
            f"The runs are of {len(made_with)} versions, so they may not be comparable. "
            f"{describe_provenance(made_with).strip()}"
        )
    outcomes = results.outcomes(part.controllers, part.seeds, part.options, part.alone)
    chosen = _chosen(request, part, outcomes)
    has_gaps, without = _has_gaps(part, outcomes)
    further = [name for name in GAP_TABLES if has_gaps and name not in part.tables]
    tables = make_tables(dataclasses.replace(part, tables=(*part.tables, *further)), results)
    further = [name for name in GAP_FIGURES if has_gaps and name not in part.figures]
    figures, not_drawn = draw_all(part, results, further) if request.figures else ([], [])
    replays, not_replayed = _replays(chosen, part, results)
    runs = _table_of_runs(part, outcomes)
    return Report(
        title=title,
        lead=_lead(part),
        notices=[*notices, *without, *not_drawn, *not_replayed],
        sections=_sections(part, tables, figures),
        replays=replays,
        playground=playground_for(part.scenarios[:REPLAYED_SCENARIOS], part.optimizer, part.options),
        runs=runs,
        facts=_facts(part, made_with),
        commands=_commands(request, part, made_with),
        configuration=configuration,
    )


def _lead(part: Suite) -> str:
    """Return the first sentence of the report."""
    return (
        f"{len(part.controllers)} controllers on {_number(len(part.scenarios), 'scenario')}, "
        f"{_number(part.num_seeds, 'seed')} each: every controller on the same scenarios and seeds."
    )


def _number(count: int, what: str) -> str:
    """Return a number with a noun in singular or plural."""
    return f"{count:,} {what}{'' if count == 1 else 's'}"


def _has_gaps(part: Suite, outcomes: Outcomes) -> tuple[bool, list[str]]:
    """Return whether there are tables and figures of gaps to add, and notices if optima are unknown."""
    if part.num_seeds == 1:
        return False, []  # intervals over seeds need several
    try:
        outcomes.gap  # noqa: B018
    except ScenarioError as error:
        return False, [f"Tables and figures of optimality gaps are left out: {error}."]
    return True, []


def _sections(part: Suite, tables: Sequence[Table], figures: Sequence[DrawnFigure]) -> list[Section]:
    """Return sections: the first table, other tables and figures of all scenarios, then each scenario."""

    def tables_of(scenario: str | None) -> list[Table]:
        return [table for table in tables if table.scenario == scenario]

    def figures_of(scenario: str | None) -> list[DrawnFigure]:
        return [figure for figure in figures if _scenario_of(figure.name, part.scenarios) == scenario]

    general = tables_of(None)
    sections = [
        Section("summary", "Results", general[:1]),
        Section("comparisons", "Quality, cost, comparisons", general[1:], figures_of(None)),
        *(
            Section(f"scenario-{place}", scenario, tables_of(scenario), figures_of(scenario))
            for place, scenario in enumerate(part.scenarios)
        ),
    ]
    return [section for section in sections if section.tables or section.figures]


def _scenario_of(name: str, scenarios: Sequence[str]) -> str | None:
    """Return the scenario that the name of a figure ends with; None if it is of several."""
    return next((scenario for scenario in scenarios if name.endswith(f"-{scenario}")), None)


def _chosen(request: Request, part: Suite, outcomes: Outcomes) -> list[RunKey]:
    """Return the runs to replay: the requested ones, or the first of some controllers on some scenarios."""
    if request.replays is not None:
        stored = {(c, s, k) for c in part.controllers for s, seeds in part.seeds.items() for k in seeds}
        for key in request.replays:
            if key not in stored:
                raise ResultsError(
                    f"{request.database} has no run of {key[0]} on {key[1]} with seed {key[2]} to replay; "
                    f"{_what_is_stored(key, part)}"
                )
        return list(request.replays)
    best = part.controllers[int(outcomes.fitness.mean(axis=(1, 2)).argmin())]
    named = [name for name in part.replayed if name in part.controllers]
    controllers = dict.fromkeys(named or [name for name in part.controllers if name in (part.baseline, best)])
    return [
        (controller, scenario, seeds.start)
        for scenario, seeds in list(part.seeds.items())[:REPLAYED_SCENARIOS]
        for controller in controllers
    ]


def _what_is_stored(key: RunKey, part: Suite) -> str:
    """Return the first part of a run's key that is not stored, and what is, in words."""
    controller, scenario, _ = key
    if controller not in part.controllers:
        return f"it has runs of {', '.join(part.controllers)}"
    if scenario not in part.seeds:
        return f"it has runs on {', '.join(part.scenarios)}"
    seeds = part.seeds[scenario]
    return f"its seeds there are {seeds.start} to {seeds.stop - 1}"


def _replays(chosen: list[RunKey], part: Suite, results: Results) -> tuple[list[dict[str, Any]], list[str]]:
    """Return packed replays by scenario and seed, and notices of runs that could not be repeated."""
    groups: dict[tuple[str, int], list[Recording]] = {}
    left_out = []
    for controller, scenario, seed in tqdm(chosen, desc="replays", unit="run"):
        [run] = results.runs(controller, scenario, 1, seed)
        try:
            groups.setdefault((scenario, seed), []).append(record(run, part))
        except ReplayError as error:
            left_out.append(f"A replay is left out, since the run cannot be repeated: {error}.")
    return [
        {
            "scenario": scenario,
            "seed": seed,
            "maps": _maps(recordings[0]),
            "replays": [pack(recording) for recording in recordings],
        }
        for (scenario, seed), recordings in groups.items()
        if recordings
    ], left_out


def _maps(recording: Recording) -> list[dict[str, Any]]:
    """Return the maps of a recording, each with the iteration from which on it holds."""
    maps: list[dict[str, Any]] = []
    before = None
    for frame in recording.frames:
        if frame.scenario is not before:
            maps.append({"from": frame.iteration, **describe_map(frame.scenario)})
            before = frame.scenario
    return maps


def _table_of_runs(part: Suite, outcomes: Outcomes) -> Table | None:
    """Return the table of all runs with all digits of their numbers; None if there are too many runs."""
    if outcomes.fitness.size > MOST_RUNS:
        return None
    rows = [
        {
            "controller": label(controller),
            "scenario": scenario,
            "seed": number(seed, ""),
            "final fitness": number(float(numbers.fitness[k]), ""),
            "collision": number(float(numbers.collision[k]), ""),
            "evaluations": number(int(numbers.evaluations[k]), ""),
            "seconds": number(float(numbers.seconds[k]), ""),
        }
        for controller in part.controllers
        for scenario, seeds in part.seeds.items()
        for numbers in [outcomes.of(controller, scenario)]
        for k, seed in enumerate(seeds)
    ]
    caption = "Every run: final fitness, degree of collision of that path, evaluations, seconds"
    return Table.of("runs", caption, rows)


def _facts(part: Suite, made_with: Sequence[Mapping[str, str]]) -> list[tuple[str, str]]:
    """Return names and values of the facts about the runs."""
    seeds = {name: f"{s.start} to {s.stop - 1}" for name, s in part.seeds.items()}
    same = len(set(seeds.values())) == 1
    told = next(iter(seeds.values())) if same else "from " + ", ".join(s.split()[0] for s in seeds.values())
    return [
        ("Suite", part.name),
        ("Optimizer", part.optimizer),
        ("Controllers", ", ".join(f"{label(name)} ({name})" for name in part.controllers)),
        ("Scenarios", ", ".join(part.scenarios)),
        ("Seeds", told),
        ("Options", ", ".join(f"{k}={v}" for k, v in part.options.items()) or "defaults"),
        ("Made with", describe_provenance(made_with).strip().removeprefix("Runs made with: ")),
    ]


def _commands(request: Request, part: Suite, made_with: Sequence[Mapping[str, str]]) -> list[str]:
    """Return the commands that make the runs and the report again."""
    commits = {provenance.get("commit", "unknown") for provenance in made_with}
    [commit] = commits if len(commits) == 1 else ["unknown"]
    checkout = [] if commit == "unknown" else [f"git checkout {commit.removesuffix('-dirty')}"]
    return [*checkout, command_of(part), f"python -m experiments.report {request.database.name}"]

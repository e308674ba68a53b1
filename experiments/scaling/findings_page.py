"""The page of the benchmark of backends: tables and the figure of measurements and predictions."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from experiments.plots.style import BLUE, GREY, RED, new_figure, settings, write_figure
from experiments.runs.runner import MOST_SEEDS
from experiments.scaling.model import Overheads, Work, predict
from experiments.scaling.overheads import Timed
from experiments.scaling.study import evaluations, trainings
from experiments.speed.benchmark_page import describe, form_of
from experiments.tables.cell import Cell, Entry, number, share
from experiments.tables.table import Row, Table, write_tables_page

CORES = (10, 100, 1000)
PRICE = 0.05  # dollars for an hour of a core; a round number, to be replaced by your own


@dataclass(frozen=True)
class Findings:
    """All measurements; see the functions of `experiments.scaling.overheads` and `experiments.scaling.study`.

    Attributes:
        machine: machine and versions.
        backends: several rounds of each backend with the same work.
        nodes: measurements on logical nodes.
        start: seconds before the first unit begins, by what they are spent on.
        empty: units of no length per second, by name of the backend.
        results: rates of units that return runs, see `count_results`.
        rows: rows per second that the database stores, by rows per transaction.
        runs: seconds of some runs of each suite, by its name.
        steps: seconds of an environment step in training, by kind of learner.
    """

    machine: dict[str, Any]
    backends: list[Timed]
    nodes: list[Timed]
    start: dict[str, float]
    empty: dict[str, float]
    results: dict[str, float]
    rows: dict[int, float]
    runs: dict[str, list[float]]
    steps: dict[str, float]

    @property
    def overheads(self) -> Overheads:
        """Return the overheads of Ray."""
        by_ray = [timed for timed in self.backends if timed.backend == "Ray"]
        return Overheads(
            start=sum(self.start.values()),
            per_unit=max(overhead_of(by_ray), 0.0) * by_ray[0].seconds,
            units_per_second=self.results["units per second"],
            rows_per_second=self.rows[MOST_SEEDS],
        )


def write_page(findings: Findings, folder: Path) -> Path:
    """Write README.md, all tables, scaling.svg and scaling.png; return the path of README.md."""
    tables = [
        overhead_table(findings),
        nodes_table(findings),
        parts_table(findings),
        work_table(findings),
        prediction_table(findings),
    ]
    with settings():
        write_figure(draw_scaling(findings), folder, "scaling")
    return write_tables_page(folder, "Scaling", tables, below=["![scaling](scaling.svg)\n"])


def overhead_table(findings: Findings) -> Table:
    """Return the table that compares backends with the same work."""
    names = list(dict.fromkeys(timed.backend for timed in findings.backends))
    by_name = {name: [timed for timed in findings.backends if timed.backend == name] for name in names}
    rows: list[Row] = []
    for name, rounds in by_name.items():
        overheads = [timed.overhead for timed in rounds]
        rows.append(
            {
                "backend": name,
                "workers": number(rounds[0].workers, "d"),
                "units": number(sum(timed.units for timed in rounds), ","),
                "wall, s": number(sum(timed.wall for timed in rounds)),
                "ideal, s": number(sum(timed.ideal for timed in rounds)),
                "overhead": share(overhead_of(rounds)),
                f"of {len(by_name[names[-1]])} rounds": Cell.of(
                    "{low:%.1f} % to {high:%.1f} %", low=min(overheads), high=max(overheads)
                ),
            }
        )
    caption = f"Units of {findings.backends[0].seconds:g} s that compute, on {describe(findings.machine)}"
    return Table.of("overhead", caption, rows)


def overhead_of(rounds: Sequence[Timed]) -> float:
    """Return the overhead of several rounds as a share of their work."""
    return sum(timed.wall for timed in rounds) / sum(timed.ideal for timed in rounds) - 1.0


def nodes_table(findings: Findings) -> Table:
    """Return the table of logical nodes, measured and predicted by the model."""
    started = replace(findings.overheads, start=0.0)
    return Table.of(
        "nodes",
        f"Logical nodes on one machine, units of {findings.nodes[0].seconds:g} s",
        [
            {
                "nodes, processors of each": timed.backend,
                "units": timed.work,
                "how many": number(timed.units, ","),
                "wall, s": number(timed.wall),
                "ideal, s": number(timed.ideal),
                "overhead": share(timed.overhead),
                "model, s": number(
                    predict(Work(timed.units, timed.seconds, timed.seconds), started, timed.workers).seconds
                ),
            }
            for timed in findings.nodes
        ],
    )


def parts_table(findings: Findings) -> Table:
    """Return the table of the parts of the model."""
    rows: list[tuple[Entry, ...]] = [
        (f"start: {what}", number(seconds, ".2f"), "s") for what, seconds in findings.start.items()
    ]
    rows += [(f"units of no length, {name}", _rate(rate), "per s") for name, rate in findings.empty.items()]
    of_runs = f"units of {MOST_SEEDS} runs and no length, into the database"
    in_ms = {
        "added to each unit by Ray": findings.overheads.per_unit,
        f"{of_runs}: processor time of the driver": findings.results["driver, seconds per unit"],
    }
    rows += [(of_runs, _rate(findings.results["units per second"]), "per s")]
    rows += [(what, number(1000 * seconds), "ms each") for what, seconds in in_ms.items()]
    rows += [(f"rows into the database, {k} at a time", _rate(r), "per s") for k, r in findings.rows.items()]
    return Table("parts", "What was measured, and the model is made of", ("part", "value", "unit"), rows)


def _rate(value: float) -> Entry:
    return number(value, form_of(value))


def work_table(findings: Findings) -> Table:
    """Return the table of the time of the study's work on one core."""
    rows: list[tuple[Entry, ...]] = [
        (
            f"a run of `{name}`",
            number(1000 * float(np.mean(s)), ".0f"),
            number(1000 * max(s), ".0f"),
            "ms",
            number(len(s), "d"),
        )
        for name, s in findings.runs.items()
    ]
    rows += [
        (f"a step of training, {kind}", number(1000 * seconds, ".3f"), "", "ms", number(1, "d"))
        for kind, seconds in findings.steps.items()
    ]
    return Table(
        "work", "What the work takes on one core", ("work", "mean", "longest", "unit", "sample"), rows
    )


def prediction_table(findings: Findings) -> Table:
    """Return the table of predicted wall time and cost on clusters."""
    rows: list[Row] = []
    for name, work_on in _works(findings).items():
        for cores in CORES:
            work = work_on(cores)
            found = predict(work, findings.overheads, cores)
            hours = cores * found.seconds / 3600
            rows.append(
                {
                    "work": name,
                    "cores": number(cores, ","),
                    "units": number(work.units, ","),
                    "wall time": Cell.of(_duration(found.seconds), value=found.seconds),
                    "bound by": found.bottleneck,
                    "core hours": number(hours, ",.1f"),
                    "of which work": number(work.units * work.seconds / 3600, ",.1f"),
                    f"dollars, at {PRICE:g} for an hour": number(PRICE * hours, ",.2f"),
                }
            )
    return Table.of("prediction", "Predicted: at most so long, and what bounds it", rows)


def draw_scaling(findings: Findings) -> Figure:
    """Draw the predicted wall time by cores, and work / cores."""
    figure = new_figure(6.4, 3.6)
    axes = figure.subplots()
    cores = np.unique(np.geomspace(1, 10_000, 81).round().astype(int))
    for (name, work_on), colour in zip(_works(findings).items(), (BLUE, RED), strict=True):
        work = [work_on(int(n)) for n in cores]
        walls = [predict(w, findings.overheads, int(n)).seconds for w, n in zip(work, cores, strict=True)]
        axes.loglog(cores, walls, color=colour, label=name)
        ideal = [w.units * w.seconds / n for w, n in zip(work, cores, strict=True)]
        axes.loglog(cores, ideal, "--", color=GREY, linewidth=0.8)
        axes.loglog(CORES, np.interp(CORES, cores, walls), "o", color=colour)
    axes.set_xlabel("cores")
    axes.set_ylabel("seconds (dashed: work / cores)")
    axes.legend()
    return figure


def _works(findings: Findings) -> dict[str, Any]:
    """Return functions from a number of cores to the work, by name of the work."""
    return {
        "all evaluations of the study": lambda cores: evaluations(findings.runs, cores),
        "ten trainings of every preset": lambda _: trainings(findings.steps),
    }


def _duration(seconds: float) -> str:
    """Return a time in seconds, minutes or hours."""
    if seconds < 120:
        return f"{seconds:.0f} s"
    return f"{seconds / 60:.0f} min" if seconds < 7200 else f"{seconds / 3600:.1f} h"

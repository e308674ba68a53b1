"""The page of a benchmark: its tables and figure, made from stored measurements."""

from pathlib import Path
from typing import Any

from matplotlib.figure import Figure

from experiments.plots.style import BLACK, BLUE, RED, new_figure, settings, write_figure
from experiments.speed import growth
from experiments.speed.environments import STEP_AND_RENDER
from experiments.speed.environments import name as vector_name
from experiments.speed.measurement import (
    CASES,
    IN_NUMPY,
    NUMPY_COST,
    Measurement,
    medians,
    read_measurements,
)
from experiments.speed.start import PEAK_OF_MANY
from experiments.speed.training import ENVIRONMENT, PACE
from experiments.tables import Table
from experiments.tables.cell import Cell, Entry, number
from swarm_gym.files import write_atomically

MOVE = ("moves", "move with evaluation, mean of the cases")
COLUMNS = ("quantity", "median", "range", "unit")
CAPTIONS = {
    "moves": "A move, a whole run, and the parts of a move",
    "environments": "Steps per second",
    "threads": "Parallel efficiency: all threads over one, runs taking turns",
    "growth": "Time and memory as things grow",
    "start": "Import, first step, memory",
    "training": "PPO training",
    "rendering": "Pictures of a swarm",
    "peers": "The same FA-60 run beside others, per evaluation",
    "bezier-peers": "Bezier curves on a grid map beside others, per evaluation",
    "fish-peers": "Artificial fish swarms beside others, per evaluation",
}
# The groups of peers.json, which need not have been measured.
OF_PEERS = ("peers", "bezier-peers", "fish-peers")


def read_folder(folder: Path) -> tuple[dict[str, Any], dict[str, list[Measurement]]]:
    """Return machine and groups of a benchmark; groups of the peers too, if they were measured.

    Raises:
        OSError: if the folder has no benchmark.
        ValueError: if a file is not a benchmark's, or if both files are of different machines or versions.
    """
    machine, groups = read_measurements(folder / "benchmark.json")
    peers = folder / "peers.json"
    if peers.exists():
        theirs, measured = read_measurements(peers)
        if theirs != machine:
            raise ValueError(f"{peers} is of another machine or version: {theirs}, not {machine}")
        groups |= measured
    return machine, groups


def write_page(folder: Path) -> Path:
    """Write README.md with all tables, growth.svg and growth.png, from the measurements in the folder."""
    machine, groups = read_folder(folder)
    parts = [f"# Benchmark\n\n{describe(machine)}\n"]
    if set(CAPTIONS) - set(OF_PEERS) <= set(groups):
        parts.append(headline(machine, groups).markdown())
    parts += [table(name, measurements).markdown() for name, measurements in groups.items()]
    if "growth" in groups:
        parts.append("![growth](growth.svg)\n")
        with settings():
            write_figure(draw_growth(groups["growth"]), folder, "growth")
    page = folder / "README.md"
    write_atomically(page, "\n".join(parts))
    return page


def describe(machine: dict[str, Any]) -> str:
    """Return a sentence about the machine and the versions."""
    return (
        f"{machine['processor']} ({machine['machine']}), {machine['threads']} threads; "
        f"Python {machine['python']}, Numba {machine['numba']}, NumPy {machine['numpy']}, "
        f"commit {machine['commit'][:7]}"
    )


def table(group: str, measurements: list[Measurement], caption: str = "") -> Table:
    """Return the table of all quantities of a group; `CAPTIONS` has the captions of those without one."""
    return Table(
        group, caption or CAPTIONS[group], COLUMNS, [_row(measurement) for measurement in measurements]
    )


def _row(m: Measurement) -> tuple[Entry, ...]:
    ends = Cell.of(
        f"{{low:{form_of(m.low)}}} to {{high:{form_of(m.high)}}}",
        low=m.low,
        high=m.high,
    )
    return m.name, number(m.median, form_of(m.median)), "" if m.low == m.high else ends, m.unit


def form_of(value: float) -> str:
    """Return the format of a number with three digits, or with all its digits before the point."""
    return ",.0f" if abs(value) >= 100 else ".3g"


def headline(machine: dict[str, Any], groups: dict[str, list[Measurement]]) -> Table:
    """Return the table of the few most important quantities of all groups."""
    moves = [("moves", f"{case}: NumPy / swarm_gym") for case in CASES]
    peers = [("peers", f"{case}: {NUMPY_COST} / swarm_gym") for case in CASES if "peers" in groups]
    others = [(group, m.name) for group, m in _other_peers(groups)]
    threads = machine["threads"]
    chosen = [
        MOVE,
        *moves,
        *peers,
        *others,
        *(("moves", f"{case}: FA-60 run of 100 iterations") for case in CASES),
        ("environments", "single environment, 60 members"),
        *(("environments", vector_name(width, 60, threads)) for width in (64, 4096)),
        *(("threads", m.name) for m in groups["threads"]),
        ("start", PEAK_OF_MANY),
        ("start", "import swarm_gym"),
        ("start", "import and first step, single, kernels cached"),
        ("start", "import and first step, single, nothing cached"),
        ("training", PACE),
        ("training", ENVIRONMENT),
        ("rendering", STEP_AND_RENDER),
    ]
    return _chosen(machine, groups, chosen)


def in_short(machine: dict[str, Any], groups: dict[str, list[Measurement]]) -> Table:
    """Return the table of five quantities, among them the ratio to the peer that comes nearest."""
    nearest = min(_other_peers(groups), key=lambda one: one[1].median)
    chosen = [
        MOVE,
        ("peers", f"{CASES[0]}: {NUMPY_COST} / swarm_gym"),
        (nearest[0], nearest[1].name),
        ("environments", vector_name(64, 60, machine["threads"])),
        ("training", PACE),
    ]
    return _chosen(machine, groups, chosen)


def _other_peers(groups: dict[str, list[Measurement]]) -> list[tuple[str, Measurement]]:
    """Return groups and ratios of the peers of other optimizers than the firefly, with cost in NumPy."""
    return [
        (group, m)
        for group in ("bezier-peers", "fish-peers")
        for m in groups.get(group, [])
        if m.name.endswith(f"{IN_NUMPY} / swarm_gym")
    ]


def _chosen(
    machine: dict[str, Any], groups: dict[str, list[Measurement]], chosen: list[tuple[str, str]]
) -> Table:
    """Return the table of the quantities with these groups and names."""
    by_name = {(group, m.name): m for group, measurements in groups.items() for m in measurements}
    rows = [_row(by_name[key]) for key in chosen]
    return Table("headline", f"Speed on {describe(machine)}", COLUMNS, rows)


def draw_growth(measurements: list[Measurement]) -> Figure:
    """Draw time (above) and memory (below) on every axis, with fitted powers."""
    found = medians(measurements)
    figure = new_figure(11.0, 5.0)
    panels = figure.subplots(2, len(growth.AXES))
    for axis, column in zip(growth.AXES, panels.T, strict=True):
        for panel, kind, name, label, colour in (
            (column[0], "time", axis.name_of_time, f"microseconds per {axis.measured}", BLUE),
            (column[1], "memory", axis.name_of_memory, "MB", RED),
        ):
            results = [found[name(value)] for value in axis.values]
            panel.loglog(axis.values, results, "o", color=colour)
            fitted = growth.fitted_line(axis.values, results)
            panel.loglog(axis.values, fitted, color=BLACK, linewidth=0.8)
            slope = found[f"exponent of {kind} in {axis.name}"]
            panel.set_title(f"{kind}: exponent {slope:.2f}")
            panel.set_xticks(axis.values, [str(value) for value in axis.values])
            panel.minorticks_off()
            panel.set_xlabel(axis.name)
            panel.set_ylabel(label)
    return figure

"""Streams of maps: a robot plans anew for each map; an obstacle comes and goes, another one trembles.

`python -m experiments.planners.streams` writes a table of docs/planners.md, for each margin by which another
corridor must be better. Shapely says whether the pieces that the robot drives are free.
"""

import math
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import count, islice
from pathlib import Path
from typing import NamedTuple

import numpy as np
import shapely
import tyro
from numpy.typing import NDArray
from scipy import ndimage

from experiments.documents.records import record_of, write_record
from experiments.tables.cell import number, share
from experiments.tables.table import Table
from swarm_gym.command import command
from swarm_gym.errors import ScenarioError
from swarm_gym.planning import plan
from swarm_gym.planning.previous import rest_of
from swarm_gym.planning.steady import SWITCH_MARGIN
from swarm_gym.problem.geometry.polylines import evenly_spaced
from swarm_gym.reference import shortest_path
from swarm_gym.runs.provenance import git_commit
from swarm_gym.scenarios import GridMap, GridScenario, make_scenario
from swarm_gym.ways import differ

Floats = NDArray[np.float64]

MAPS = 50  # of a stream
PERIOD = 3  # maps for which the obstacle is there, or is away
DISC, TREMBLING = 0.06, 0.04  # radii of the two obstacles, as shares of the longer side of the map
TREMBLE = 1.0  # how far the centre of the second one moves, in cells
PLACES = (0.45, 0.75)  # of the two obstacles on the first shortest path, as shares of its length
STEPS = 25  # steps of the robot, if it drove along the first shortest path


@dataclass(frozen=True)
class StreamsConfig:
    """Options of the study."""

    output: Path = Path("results/planners")
    """Folder that the table is written to."""
    streams: int = 10
    """Number of streams on rooms, and on caves."""
    margins: tuple[float, ...] = (0.0, SWITCH_MARGIN, 0.2)
    """Margins to compare; 0 takes the best path anyway."""
    radius: float = 0.4
    """Radius of the robot, in cells."""


class Stream(NamedTuple):
    """The maps of a stream, one for each time at which the robot plans."""

    first: GridScenario
    blocked: list[NDArray[np.bool_]]


class Drive(NamedTuple):
    """A drive through a stream.

    Attributes:
        flips: times at which an obstacle of both maps lay between the path and the rest of the one before.
        seconds: CPU time of each planning.
        length: length that the robot drove, over that of the first shortest path.
        arrived: whether it arrived within the stream.
        hits: pieces that it drove which were not free, by shapely.
    """

    flips: int
    seconds: list[float]
    length: float
    arrived: bool
    hits: int


def make_stream(scenario: GridScenario, seed: int, maps: int = MAPS) -> Stream:
    """Return a stream of maps on which an obstacle comes and goes, and another one trembles."""
    rng, grid = np.random.default_rng(seed), scenario.map
    path = evenly_spaced(grid.to_cells(shortest_path(scenario)[1]), 101)
    side = max(grid.width, grid.height)
    centres = [path[round(100 * place)] for place in PLACES]
    blocked = []
    for number_of_map in range(maps):
        cells = grid.blocked | grid.disc(centres[1] + rng.uniform(-TREMBLE, TREMBLE, 2), TREMBLING * side)
        if number_of_map // PERIOD % 2 == 1:
            cells = cells | grid.disc(centres[0], DISC * side)
        blocked.append(cells)
    return Stream(scenario, blocked)


def drive(stream: Stream, margin: float, radius: float) -> Drive:
    """Return the drive of a robot that plans from its previous path for each map, and drives one step.

    Where no path leads on, or an obstacle appears on the robot, it waits for the next map.

    Args:
        stream: the maps.
        margin: margin by which another corridor must be better.
        radius: radius of the robot, in map units.
    """
    first = stream.first
    grid, here = first.map, first.start
    whole = shortest_path(first)[0]
    previous: Floats | None = None
    blocked_before = grid.blocked
    flips, hits, driven = 0, 0, 0.0
    seconds: list[float] = []
    for blocked in stream.blocked:
        now = GridMap(grid.name, blocked, grid.resolution, grid.origin, grid.y_up)
        before = None if previous is None else rest_of(previous, here)
        began = time.process_time()
        try:
            found = plan(now, here, first.target, robot_radius=radius, previous=before, switch_margin=margin)
        except ScenarioError:
            continue  # it waits
        seconds.append(time.process_time() - began)
        if before is not None:
            flips += _lie_apart(grid, blocked & blocked_before, before, found.path)
        blocked_before = blocked
        piece = _beginning(found.path, whole / STEPS)
        hits += not _is_free(now, piece, radius)
        driven += float(np.hypot(*np.diff(piece, axis=0).T).sum())
        x, y = piece[-1].tolist()
        here, previous = (x, y), found.path
        if math.dist(here, first.target) < whole / STEPS / 100.0:
            return Drive(flips, seconds, driven / whole, True, hits)
    return Drive(flips, seconds, driven / whole, False, hits)


def stream_table(drives: Sequence[tuple[float, Drive]]) -> Table:
    """Return the table of drives, each with its margin."""
    rows = []
    for margin in dict.fromkeys(margin for margin, _ in drives):
        own = [one for other, one in drives if other == margin]
        times = np.array([second for one in own for second in one.seconds])
        rows.append(
            {
                "margin": share(margin, ".0f"),
                "streams": number(len(own), "d"),
                "replannings": number(len(times), ",d"),
                "flips per stream": number(float(np.mean([one.flips for one in own])), ".1f"),
                "arrived": share(float(np.mean([one.arrived for one in own]))),
                "pieces not free": number(sum(one.hits for one in own), "d"),
                "length driven": share(float(np.mean([one.length for one in own]))),
                "mean CPU time, ms": number(1000.0 * float(times.mean()), ".1f"),
                "slowest 1 %, ms": number(1000.0 * float(np.quantile(times, 0.99)), ".0f"),
            }
        )
    caption = (
        f"Streams of {MAPS} maps on which an obstacle comes and goes and another one trembles, by the margin "
        "by which another corridor must be better: replannings; changes of corridor; share of streams in "
        "which the robot arrived; driven pieces that shapely finds not free; mean length driven, of the "
        "first shortest path; mean and 99 % quantile of the CPU time of a replanning"
    )
    return Table.of("streams", caption, rows)


def streams(config: StreamsConfig) -> Path:
    """Drive through all streams with each margin, write the table, and return its file."""
    made = [
        stream
        for kind in ("rooms", "caves")
        for stream in islice(_streams(kind, config.radius), config.streams)
    ]
    drives = [
        (margin, drive(stream, margin, config.radius * stream.first.map.resolution))
        for margin in config.margins
        for stream in made
    ]
    config.output.mkdir(parents=True, exist_ok=True)
    table = stream_table(drives)
    table.write(config.output)
    write_record(record_of("streams", [git_commit()], {}), config.output)
    return config.output / f"{table.name}.md"


def _streams(kind: str, radius: float) -> Iterator[Stream]:
    """Yield streams on maps of a kind on which both obstacles leave a way for a robot, radius in cells."""
    for index in count():
        scenario = make_scenario(f"{kind}:{index}")
        assert isinstance(scenario, GridScenario)
        stream = make_stream(scenario, index)
        grid, ends = scenario.map, (scenario.start, scenario.target)
        for blocked in stream.blocked:
            try:
                plan(
                    GridMap(grid.name, blocked, grid.resolution, grid.origin, grid.y_up),
                    *ends,
                    robot_radius=radius * grid.resolution,
                )
            except ScenarioError:
                break
        else:
            yield stream


def _beginning(path: Floats, length: float) -> Floats:
    """Return the first piece of a path, (k, 2), of that length, or the whole path."""
    along = np.append(0.0, np.cumsum(np.hypot(*np.diff(path, axis=0).T)))
    if along[-1] <= length:
        return path
    behind = int(np.searchsorted(along, length, side="right"))
    end = np.array([np.interp(length, along, path[:, k]) for k in range(2)])
    return np.vstack([path[:behind], end])


def _lie_apart(grid: GridMap, blocked: NDArray[np.bool_], path: Floats, other: Floats) -> bool:
    """Return whether blocked cells lie between two paths, (k, 2), with the same ends."""
    labels, number_of_obstacles = ndimage.label(blocked, np.ones((3, 3)))
    cells = ndimage.maximum_position(
        ndimage.distance_transform_cdt(blocked), labels, np.arange(1, number_of_obstacles + 1)
    )
    return differ(path, other, grid.to_map(np.array(cells).reshape(-1, 2)[:, ::-1]))


def _is_free(grid: GridMap, piece: Floats, radius: float) -> bool:
    """Return whether a disc along a piece of a path stays out of blocked cells, by shapely."""
    line = shapely.LineString(piece)
    near = np.argwhere(grid.blocked)
    middles = grid.to_map(near[:, ::-1])
    half = grid.resolution / 2.0
    cells = shapely.box(*(middles - half).T, *(middles + half).T)
    return bool((shapely.distance(cells, line) >= radius - 1e-6 * grid.resolution).all())


def main() -> None:
    """Make the table and print where it is."""
    config = tyro.cli(StreamsConfig, description=__doc__)
    with command():
        print(streams(config))


if __name__ == "__main__":
    main()

"""The planner of flights: the straight line where it can be flown, and the best flight of a swarm."""

import math
import time
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import cast

from swarm_gym.checks import require_integer, require_number
from swarm_gym.errors import NoPathError, ScenarioError, shown
from swarm_gym.outputs import files_named
from swarm_gym.planning.flights.measures import measured
from swarm_gym.planning.flights.result import Flight
from swarm_gym.planning.flights.search import EPISODES, FlightSearch
from swarm_gym.planning.flights.writing import require_formats, require_places
from swarm_gym.scenarios import TerrainScenario, make_scenario
from swarm_gym.scenarios.formats.data_files import find_data_file
from swarm_gym.scenarios.formats.elevation_files import READERS
from swarm_gym.scenarios.terrain import file_family
from swarm_gym.scenarios.terrain.survey import Limits, Survey, survey

Point3 = tuple[float, float, float]


def plan_flight(
    where: str | Path | TerrainScenario,
    start: Point3 | None = None,
    goal: Point3 | None = None,
    *,
    threats: str | Path | None = None,
    altitude: tuple[float, float] | None = None,
    largest_turn: float | None = None,
    largest_climb: float | None = None,
    drone_size: float | None = None,
    danger_distance: float | None = None,
    coordinates: str | None = None,
    optimizer: str | None = None,
    controller: str | None = None,
    max_evaluations: int | None = None,
    max_seconds: float | None = None,
    seed: int = 0,
    outputs: Sequence[Path] = (),
) -> Flight:
    """Return a short flight over terrain that keeps to the altitude band and the limits, and out of threats.

    A coarse graph, and swarms that begin around its flights, look for routes, seen from above. Over each
    route the shortest flight in the altitude band is known, see `profile`, and whether there is one.
    Episodes run until a budget is spent, each from another seed; without a budget, `EPISODES` do. With more
    evaluations the flight is never longer. Where the straight line can be flown, it is the result, unless an
    optimizer, a controller or a budget is named.

    Args:
        where: an elevation model (`.tif`, `.asc`, `.hgt`), a scenario, or its name such as "terrain:test:0".
        start: x, y or longitude, latitude, and height above ground; a scenario has its own.
        goal: x, y or longitude, latitude, and height above ground; a scenario has its own.
        threats: GeoJSON file of points with a radius, see `swarm_gym.scenarios.formats.threat_file`.
        altitude: least and greatest height above ground, in metres. This and the next four are those of the
            scenario by default; for an elevation model 100 to 200 metres, 45 and 45 degrees, 1 and 10 metres.
        largest_turn: largest turn at a waypoint, in degrees.
        largest_climb: largest angle of climb or descent, in degrees.
        drone_size: distance from a threat that counts as contact, in metres.
        danger_distance: width of the zone around threats that the swarm avoids where it can, in metres.
        coordinates: "plane" or "longitude-latitude"; by default the kind of the elevation model.
        optimizer: name of the optimizer; by default one that suits flights.
        controller: name of the controller; by default a fixed population size.
        max_evaluations: evaluations after which no further episode begins, and at least one does.
        max_seconds: seconds after which planning ends. A map is read whole, and a flight looked for along the
            coarse graph at least, if the straight line cannot be flown.
        seed: seed of the first episode.
        outputs: names of files for a later call of `write_flight`; nothing is written here. A wrong ending,
            a file that is read, or a format that the map does not allow, is refused before planning.

    Raises:
        ScenarioError: for files, a start, a goal or limits that are invalid.
        SettingError: for another value that is invalid.
        NoPathError: if no flight was found within the budget.
        KeyboardInterrupt: after Ctrl-C before a flight was found; after it, the best flight is returned.
        MissingExtraError: if a file or an output needs a library that is missing.
    """
    require_integer("seed", seed, 0, 2**31)
    if max_seconds is not None:
        require_number("max_seconds", max_seconds, 1e-3, 1e9)
    if max_evaluations is not None:
        require_integer("max_evaluations", max_evaluations, 1)
    require_formats(outputs, (threats, *files_named(where)))
    began = time.monotonic()
    given = {
        "altitude": altitude,
        "largest_turn": largest_turn,
        "largest_climb": largest_climb,
        "drone_size": drone_size,
        "danger_distance": danger_distance,
    }
    limits = cast(Limits, {name: value for name, value in given.items() if value is not None})
    task = _task(where, start, goal, threats, coordinates, limits)
    require_places(outputs, task)
    search = FlightSearch(task, optimizer, controller, seed, began)
    search.begin()
    stopped = False
    if not search.improvements or optimizer or controller or max_evaluations or max_seconds:
        stopped = search.run_until(
            math.inf if max_evaluations is None else max_evaluations,
            math.inf if max_seconds is None else began + max_seconds,
            math.inf if max_evaluations or max_seconds else EPISODES,
        )
    seconds = time.monotonic() - began
    if not search.improvements:
        if stopped:
            raise KeyboardInterrupt
        climb = search.least_climb()
        steep = climb > task.scenario.largest_climb and math.isfinite(climb)
        raise NoPathError(
            f"no flight found over {task.scenario.name!r} with {search.evaluations:,} evaluations in "
            f"{seconds:.2f} "
            f"seconds; {f'each route needs a climb of {climb:.0f} degrees or more, so ' if steep else ''}"
            "a larger budget, a wider altitude band or larger angles may help"
        )
    best = search.improvements[-1]
    return Flight(
        task,
        best.waypoints,
        best.length,
        *measured(task, best.waypoints),
        search.evaluations,
        seconds,
        best.found_by,
        stopped,
        tuple(search.improvements),
    )


def _task(
    where: str | Path | TerrainScenario,
    start: Point3 | None,
    goal: Point3 | None,
    threats: str | Path | None,
    coordinates: str | None,
    limits: Limits,
) -> Survey:
    """Return the task of a flight; see `plan_flight`."""
    if not is_elevation(where):
        given = {"start": start, "goal": goal, "threats": threats, "coordinates": coordinates}
        return _named(where, given, limits)
    if start is None or goal is None:
        raise ScenarioError(
            f"map {shown(str(where))}: a file needs a start and a goal, x, y and height above ground"
        )
    near = None if threats is None else _found(threats)
    return survey(_found(str(where)), start, goal, threats=near, coordinates=coordinates, **limits)


def is_elevation(where: object) -> bool:
    """Return whether a map is an elevation model, by the ending of its name."""
    named = isinstance(where, str | Path) and not str(where).startswith(f"{file_family.NAME}:")
    return named and Path(str(where)).suffix.lower() in READERS


def _found(path: str | Path) -> Path:
    """Return a file by its path from the current folder, or by its name in the data folder."""
    if Path(path).is_file():
        return Path(path)
    if Path(path).exists():
        raise ScenarioError(f"{path}: expected a file, this is a folder")
    try:
        return find_data_file(str(path))
    except ScenarioError as error:
        raise ScenarioError(f"{error}; nor is there a file {path} from {Path.cwd()}") from error


def _named(where: str | Path | TerrainScenario, given: Mapping[str, object], limits: Limits) -> Survey:
    """Return the task of a scenario or of its name, with other limits; nothing else may be given."""
    for role, value in given.items():
        if value is not None:
            raise ScenarioError(f"map {shown(str(where))}: a scenario has its own {role}; leave it out")
    if isinstance(where, str) and where.strip().startswith(f"{file_family.NAME}:"):
        return file_family.surveyed(file_family.FAMILY.tidy(where), limits)
    scenario = make_scenario(str(where) if isinstance(where, Path) else where)
    if not isinstance(scenario, TerrainScenario):
        raise ScenarioError(
            f"map {shown(scenario.name)}: expected terrain to fly over: {', '.join(READERS)}, or a "
            "scenario such as "
            "terrain:test:0"
        )
    return Survey(
        replace(
            scenario,
            band=limits.get("altitude", scenario.band),
            largest_turn=limits.get("largest_turn", scenario.largest_turn),
            largest_climb=limits.get("largest_climb", scenario.largest_climb),
            drone_size=limits.get("drone_size", scenario.drone_size),
            danger_distance=limits.get("danger_distance", scenario.danger_distance),
        )
    )

"""The command that plans a flight: `python -m swarm_gym.plan --map dem.tif --start ... --goal ...`."""

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from swarm_gym.command import (
    INTERRUPTED,
    NumberParser,
    budget,
    quiet_without_readers,
    warnings_in_a_line,
)
from swarm_gym.errors import MissingExtraError, NoPathError, SwarmGymError
from swarm_gym.planning.flights.planner import is_elevation, plan_flight
from swarm_gym.planning.flights.result import Flight
from swarm_gym.planning.flights.writing import FORMATS, write_flight
from swarm_gym.scenarios.formats.geographic import COORDINATES
from swarm_gym.scenarios.terrain import file_family, generated, uav56

INVALID, NO_PATH = 2, 3  # exit statuses
FAMILIES = (generated.NAME, file_family.NAME, uav56.NAME)
MOST_LISTED = 5  # threats

EXAMPLES = """examples:
  python -m swarm_gym.plan --map N46E007.hgt --start 7.40,46.50,150 --goal 7.48,46.52,150 --output flight.plan
  python -m swarm_gym.plan --map dem.tif --threats threats.geojson --start 7.40,46.50,150 \\
      --goal 7.48,46.52,150 --altitude 100..200 --budget 5s --output flight.kml --output flight.png
  python -m swarm_gym.plan --map terrain:test:0 --output flight.html

exit status: 0 with a flight, 2 for invalid input, 3 if no flight was found, 130 after Ctrl-C without one
"""


def flies(arguments: Sequence[str]) -> bool:
    """Return whether the map of a command line is one to fly over: an elevation model, or such a scenario."""
    parser = argparse.ArgumentParser(add_help=False, exit_on_error=False)
    parser.add_argument("--map")
    try:
        found = parser.parse_known_args(list(arguments))[0].map
    except (argparse.ArgumentError, SystemExit):
        return False
    named = found is not None and found.strip().startswith(tuple(f"{family}:" for family in FAMILIES))
    return named or is_elevation(found)


def main(arguments: Sequence[str]) -> int:
    """Plan a flight, print what is known of it and write it; return the exit status."""
    options = _parser().parse_args(arguments)
    try:
        evaluations, seconds = options.budget
        with quiet_without_readers(), warnings_in_a_line():
            found = plan_flight(
                options.map,
                options.start,
                options.goal,
                threats=options.threats,
                altitude=options.altitude,
                largest_turn=options.max_turn,
                largest_climb=options.max_climb,
                drone_size=options.drone_size,
                coordinates=options.coordinates,
                optimizer=options.optimizer,
                controller=options.controller,
                max_evaluations=evaluations,
                max_seconds=seconds,
                seed=options.seed,
                outputs=options.output,
            )
            write_flight(found, *options.output)
            print(described(found))
            if options.output:
                print(f"written to {', '.join(map(str, options.output))}")
    except KeyboardInterrupt:
        print("interrupted before a flight was found or written", file=sys.stderr)
        return INTERRUPTED
    except NoPathError as error:
        print(f"no flight: {error}", file=sys.stderr)
        return NO_PATH
    except (SwarmGymError, MissingExtraError, ValueError, OSError) as error:
        print(f"error: {error}", file=sys.stderr)
        return INVALID
    return 0


def described(found: Flight) -> str:
    """Return what is known of a flight in lines."""
    lines = [
        f"length        {found.length:,.1f} m",
        f"above ground  {found.least_height:.1f} to {found.greatest_height:.1f} m",
        f"climb         {found.steepest_climb:.1f} degrees at most",
        f"turn          {found.sharpest_turn:.1f} degrees at most",
        f"waypoints     {len(found.waypoints)}",
        *(
            f"threat {one.number:<6} passed "
            + (f"at {one.distance:,.1f} m" if one.distance >= 0.0 else "over its top")
            for one in found.passed[:MOST_LISTED]
        ),
        *([f"threats       {len(found.passed)} in all"] if len(found.passed) > MOST_LISTED else []),
        f"evaluations   {found.evaluations:,}",
        f"seconds       {found.seconds:.3f}",
        f"found by      {found.found_by}",
    ]
    return "\n".join(["stopped by Ctrl-C", *lines] if found.stopped else lines)


def _parser() -> argparse.ArgumentParser:
    parser = NumberParser(
        prog="python -m swarm_gym.plan",
        description="Plan a flight over terrain, between two heights above ground and out of threats.",
        epilog=EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument(
        "--map",
        required=True,
        help="an elevation model (.tif of GeoTIFF, .asc of ESRI, .hgt of SRTM), or a scenario's name, e.g. "
        "terrain:test:0",
    )
    for role in ("start", "goal"):
        parser.add_argument(
            f"--{role}",
            type=_place,
            metavar="X,Y,HEIGHT",
            help=f"{role}: longitude and latitude, or x and y of the map, and height above ground in metres",
        )
    parser.add_argument(
        "--threats",
        type=Path,
        metavar="FILE",
        help="GeoJSON file of points, each with a radius and maybe a height or top as property, in metres",
    )
    parser.add_argument(
        "--altitude",
        type=_band,
        metavar="LEAST..GREATEST",
        help="heights above ground that are allowed, in metres (default: 100..200, or those of the scenario)",
    )
    parser.add_argument(
        "--max-turn",
        type=float,
        metavar="DEGREES",
        help="largest turn at a waypoint, seen from above (default: 45, or that of the scenario)",
    )
    parser.add_argument(
        "--max-climb",
        type=float,
        metavar="DEGREES",
        help="largest angle of climb or descent (default: 45, or that of the scenario)",
    )
    parser.add_argument(
        "--drone-size",
        type=float,
        metavar="METRES",
        help="distance from a threat that counts as contact, e.g. half the span (default: 1, or that of the "
        "scenario)",
    )
    parser.add_argument(
        "--coordinates",
        choices=COORDINATES,
        help="kind of the coordinates of start, goal and threats (default: that of the map)",
    )
    parser.add_argument("--optimizer", help="name of the optimizer (default: one that suits flights)")
    parser.add_argument("--controller", help="name of the controller (default: a fixed population size)")
    parser.add_argument(
        "--budget",
        type=budget,
        default=(None, None),
        metavar="N|Ns",
        help="evaluations, e.g. 50000, or seconds, e.g. 5s; episodes begin until it is spent (default: six "
        "episodes)",
    )
    parser.add_argument("--seed", type=int, default=0, help="seed of the first episode (default: 0)")
    parser.add_argument(
        "--output",
        type=Path,
        action="append",
        default=[],
        metavar="FILE",
        help=f"file for the flight; its ending says how: {', '.join(FORMATS)}; may be given several times",
    )
    return parser


def _place(text: str) -> tuple[float, float, float]:
    """Return the three numbers of an argument `x,y,height`."""
    try:
        x, y, height = (float(number) for number in text.split(","))
    except ValueError as error:
        raise argparse.ArgumentTypeError(f"expected three numbers x,y,height, got {text!r}") from error
    return x, y, height


def _band(text: str) -> tuple[float, float]:
    """Return the two numbers of an argument `least..greatest`."""
    try:
        least, greatest = (float(number) for number in text.split(".."))
    except ValueError as error:
        raise argparse.ArgumentTypeError(
            f"expected two heights in metres such as 100..200, got {text!r}"
        ) from error
    return least, greatest

"""Plan a path on a map: `python -m swarm_gym.plan --map warehouse.yaml --start 0,0 --goal 8,3`.

Over an elevation model, such as `--map dem.tif`, it plans a flight, see `swarm_gym.planning.flights`.
The function is `swarm_gym.plan`, see `swarm_gym.planning`. Since this module has the same name, it can be
called like the function.
"""

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path
from types import ModuleType
from typing import Any

from swarm_gym.command import (
    INTERRUPTED,
    NumberParser,
    budget,
    point,
    quiet_without_readers,
    warnings_in_a_line,
)
from swarm_gym.errors import MissingExtraError, NoPathError, SettingError, SwarmGymError
from swarm_gym.planning.drive_costs import USUAL
from swarm_gym.planning.flights import command_line
from swarm_gym.planning.flights.command_line import INVALID, NO_PATH
from swarm_gym.planning.maps import files_of
from swarm_gym.planning.planner import plan
from swarm_gym.planning.previous import read_previous
from swarm_gym.planning.request import PLANNERS
from swarm_gym.planning.result import Plan
from swarm_gym.planning.steady import SWITCH_MARGIN
from swarm_gym.planning.wishes import WISHES
from swarm_gym.planning.writing import FORMATS, require_formats, write_plan
from swarm_gym.problem.geometry.polylines import length_of
from swarm_gym.scenarios.formats.geographic import COORDINATES
from swarm_gym.scenarios.graded_map import UNKNOWN_CELLS

EXAMPLES = """examples:
  python -m swarm_gym.plan --map case2 --output path.csv
  python -m swarm_gym.plan --map warehouse.yaml --start 1,2 --goal 8.5,3 --robot-radius 0.2 --output path.yaml
  python -m swarm_gym.plan --map arena.map --start 1,12 --goal 3,40 --budget 2s --output path.svg
  python -m swarm_gym.plan --map warehouse.yaml --start 1,2 --goal 8,3 --unknown dear --wishes distance=2
  python -m swarm_gym.plan --map case2 --turning-radius 20 --goal-heading 90 --output path.csv
  python -m swarm_gym.plan --map case2 --alternatives 3 --output paths.geojson
  python -m swarm_gym.plan --map yard.geojson --start 1,2 --goal 8,3 --workspace 0,0,9,5 --output path.csv

Over terrain (.tif, .asc, .hgt, or a scenario such as terrain:test:0) it plans a flight, with other options:
  python -m swarm_gym.plan --map dem.tif --help

exit status: 0 with a path, 2 for invalid input, 3 if there is no path or none was found, 130 after Ctrl-C
without one
"""


def main(arguments: Sequence[str] | None = None) -> int:
    """Plan a path or a flight, print what is known of it and write it; return the exit status."""
    given = sys.argv[1:] if arguments is None else arguments
    if command_line.flies(given):
        return command_line.main(given)
    options = _parser().parse_args(given)
    try:
        if options.switch_margin is not None and options.previous is None:
            raise SettingError("--switch-margin: it compares with a previous path; give --previous, too")
        read = [*files_of(options.map), options.workspace, options.previous]
        require_formats(options.output, read, options.alternatives)
        evaluations, seconds = options.budget
        with quiet_without_readers(), warnings_in_a_line():
            found = plan(
                options.map,
                options.start,
                options.goal,
                robot_radius=options.robot_radius,
                clearance=options.clearance,
                planner=options.planner,
                optimizer=options.optimizer,
                controller=options.controller,
                max_evaluations=evaluations,
                max_seconds=seconds,
                seed=options.seed,
                previous=None if options.previous is None else read_previous(options.previous),
                workspace=options.workspace,
                coordinates=options.coordinates,
                unknown=options.unknown,
                lethal=options.lethal,
                terrain=options.terrain,
                wishes=options.wishes,
                alternatives=options.alternatives,
                switch_margin=SWITCH_MARGIN if options.switch_margin is None else options.switch_margin,
                turning_radius=options.turning_radius,
                start_heading=options.start_heading,
                goal_heading=options.goal_heading,
                reverse=options.reverse,
                curvature_rate=options.curvature_rate,
            )
            written = write_plan(found, *options.output)
            print(_described(found))
            if written:
                print(f"written to {', '.join(map(str, written))}")
    except KeyboardInterrupt:
        print("interrupted before a path was found or written", file=sys.stderr)
        return INTERRUPTED
    except NoPathError as error:
        print(f"no path: {error}", file=sys.stderr)
        return NO_PATH
    except (SwarmGymError, MissingExtraError, ValueError, OSError) as error:
        print(f"error: {error}", file=sys.stderr)
        return INVALID
    return 0


def _parser() -> argparse.ArgumentParser:
    parser = NumberParser(
        prog="python -m swarm_gym.plan",
        description="Plan a short free path on a map: exactly where that is quick, else with a swarm.",
        epilog=EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument(
        "--map",
        required=True,
        help="a file (.yaml or .yml of ROS's map_server, .map of Moving AI, .geojson), or a "
        "scenario's name, e.g. case1",
    )
    parser.add_argument("--start", type=point, metavar="X,Y", help="start, in the map's units")
    parser.add_argument("--goal", type=point, metavar="X,Y", help="goal, in the map's units")
    parser.add_argument(
        "--robot-radius", type=float, default=0.0, metavar="R", help="radius of the robot, in the map's units"
    )
    parser.add_argument(
        "--clearance",
        type=float,
        default=0.0,
        metavar="D",
        help="distance that the robot keeps from obstacles besides, in the map's units",
    )
    parser.add_argument(
        "--turning-radius",
        type=float,
        metavar="R",
        help="radius of the smallest circle that the robot can drive, in the map's units; the path is then "
        "a curve (default: it turns on the spot)",
    )
    parser.add_argument(
        "--start-heading",
        type=float,
        metavar="DEGREES",
        help="heading at the start with a turning radius, from the x axis towards the y axis, e.g. 90 "
        "(default: any)",
    )
    parser.add_argument(
        "--goal-heading",
        type=float,
        metavar="DEGREES",
        help="heading at the goal with a turning radius, in the same way (default: any)",
    )
    parser.add_argument(
        "--curvature-rate",
        type=float,
        metavar="RATE",
        help="greatest change of curvature over length with a turning radius, in 1 / unit squared, e.g. 0.5 "
        "(default: curvature may jump)",
    )
    parser.add_argument(
        "--reverse", action="store_true", help="the robot may drive backwards, with a turning radius"
    )
    parser.add_argument(
        "--planner",
        choices=PLANNERS,
        default=PLANNERS[0],
        help="auto: the exact shortest path where it is quickly known, else a swarm; swarm: a swarm alone "
        "(default: auto)",
    )
    parser.add_argument(
        "--workspace",
        metavar="X_MIN,Y_MIN,X_MAX,Y_MAX|FILE",
        help="area that the robot stays in, on maps of obstacles: a box, e.g. 0,0,20,10, or a .geojson file "
        "with one polygon (default: no limit)",
    )
    parser.add_argument(
        "--coordinates",
        choices=COORDINATES,
        help="kind of the coordinates of a .geojson file; with longitude-latitude, radius, clearance and "
        "length are in metres (default: what the file names, else plane)",
    )
    parser.add_argument(
        "--unknown",
        choices=UNKNOWN_CELLS,
        default=UNKNOWN_CELLS[0],
        help="what cells are that a map of ROS does not know; dear: free at a cost of ground of 1 "
        "(default: blocked)",
    )
    parser.add_argument(
        "--lethal",
        type=int,
        metavar="V",
        help="value from which cells of a map of ROS are blocked (default: 100, on cost maps 253)",
    )
    parser.add_argument(
        "--terrain",
        type=_weights,
        metavar="LETTER=COST,...",
        help="cost of ground by letter on a map of Moving AI, e.g. S=2,W=inf; inf blocks (default: letters "
        "are free or blocked)",
    )
    parser.add_argument(
        "--wishes",
        type=_weights,
        metavar="NAME=WEIGHT,...",
        help=f"what the path shall keep low besides its length, of {', '.join(WISHES)}; e.g. distance=2 "
        "(default: ground=1 on maps with grades, and "
        + ", ".join(f"{name}={weight:g}" for name, weight in USUAL.items())
        + " with a turning radius)",
    )
    parser.add_argument(
        "--alternatives",
        type=int,
        default=1,
        metavar="K",
        help="number of paths, at most, no two through the same corridor (default: 1)",
    )
    parser.add_argument("--optimizer", help="name of the optimizer; by default one that suits the map")
    parser.add_argument(
        "--controller", help="name of the controller; by default one that suits the optimizer"
    )
    parser.add_argument(
        "--budget",
        type=budget,
        default=(None, None),
        metavar="N|Ns",
        help="evaluations, e.g. 50000, or seconds, e.g. 2s; episodes begin until it is spent (default: five "
        "episodes)",
    )
    parser.add_argument("--seed", type=int, default=0, help="seed of the first episode (default: 0)")
    parser.add_argument(
        "--previous",
        type=Path,
        metavar="FILE",
        help="path from before the map changed, from which planning goes on: a .csv file of --output",
    )
    parser.add_argument(
        "--switch-margin",
        type=float,
        metavar="SHARE",
        help="share by which a path in another corridor than --previous must be better; 0 takes the best "
        f"path (default: {SWITCH_MARGIN:g})",
    )
    parser.add_argument(
        "--output",
        type=Path,
        action="append",
        default=[],
        metavar="FILE",
        help=f"file for the path; its ending says how: {', '.join(FORMATS)}; may be given several times; "
        "alternatives go to files numbered from -2 on, or all into one .geojson",
    )
    return parser


def _weights(text: str) -> dict[str, float]:
    """Return the numbers of an argument `name=number,...` by name.

    Raises:
        argparse.ArgumentTypeError: for any other text.
    """
    found: dict[str, float] = {}
    for part in text.split(","):
        name, _, number = part.partition("=")
        if name.strip() in found:
            raise argparse.ArgumentTypeError(f"{name.strip()} is given twice in {text!r}")
        try:
            found[name.strip()] = float(number)
        except ValueError as error:
            raise argparse.ArgumentTypeError(
                f"expected name=number, e.g. distance=2, got {part!r}"
            ) from error
    return found


def _described(found: Plan) -> str:
    gap = "unknown" if found.gap is None else f"{round(100.0 * found.gap, 2) + 0.0:.2f} %"  # no -0.00
    lines = [
        f"length       {found.length:.6g}",
        f"clearance    {found.clearance:.6g}",
        f"above exact  {gap}",
        f"evaluations  {found.evaluations:,}",
        f"seconds      {found.seconds:.3f}",
        f"found by     {found.found_by}",
    ]
    lines += [f"{name:<12} {cost:.6g}" for name, cost in found.costs.items() if name != "length"]
    if found.curve is not None:
        lines.append(f"{'least radius':<12} {found.curve.least_radius:.6g}")
    if found.switched is not None:
        lines.append(f"{'corridor':<12} {'another one' if found.switched else 'that of the previous path'}")
    for number, other in enumerate(found.alternatives[1:], 2):
        costs = ", ".join(f"{name} {value:.6g}" for name, value in other.costs.items())
        lines.append(f"{f'path {number}':<12} {costs}, clearance {other.clearance:.6g}")
    lines += [
        f"{'no curve':<12} through another corridor, whose shortest path has length {length_of(path):.6g}"
        for path in map(found.on_map, found.undrivable)
    ]
    return "\n".join(["stopped by Ctrl-C", *lines] if found.stopped else lines)


class _Callable(ModuleType):
    def __call__(self, *arguments: Any, **options: Any) -> Plan:
        return plan(*arguments, **options)


if __name__ == "__main__":
    sys.exit(main())
else:
    sys.modules[__name__].__class__ = _Callable

"""Compare controllers on the same scenarios and seeds: `swarm-gym compare spsfa-tip learned:three-cases/0@1`.

The table has a row for each controller. The objective is the optimality gap in per cent plus the price of the
evaluations; smaller is better. Brackets are 95 % bootstrap intervals over scenarios of a set and seeds. The
column of a scenario has the mean gap and the mean number of evaluations. Feasible is the share of runs whose
best path by fitness is free; such a path may graze obstacles.

`swarm-gym compare theory one-fifth --scenarios onemax:100 --optimizer one-plus-lambda-lambda` compares on bit
strings. There the table has the evaluations until the optimum instead. It also has how far they are above the
expected evaluations of the optimal control of lambda, where these ship.

`swarm-gym compare fixed:60 linear-reduction --scenarios terrain:test:3 --optimizer differential-evolution
--cost metabox --source guided --iterations 220 --max-evaluations 2500` compares over terrain. There the table
has the cost, since optima are unknown.
"""

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from swarm_gym.checks import require_integer, require_number
from swarm_gym.command import command
from swarm_gym.comparing.comparison import CASES, compare
from swarm_gym.errors import MissingExtraError, SwarmGymError
from swarm_gym.files import write_atomically
from swarm_gym.outputs import files_named, require_outputs

HIGHEST_PRICE = 1e9
MOST_SEEDS = 100_000  # validation and training take their seeds above
# Options that reach all environments where they are given.
OPTIONS = ("encoding", "source", "cost", "iterations", "max_evaluations")


def main(arguments: Sequence[str] | None = None) -> None:
    """Compare as the command line says, and print the table."""
    given = _parser().parse_args(arguments)
    with command(SwarmGymError, MissingExtraError):
        require_number("--price", given.price, 0.0, HIGHEST_PRICE)
        require_integer("--first-seed", given.first_seed, 0, MOST_SEEDS - 2)
        require_integer("--seeds", given.seeds, 1, MOST_SEEDS - given.first_seed)
        if given.output is not None:
            require_outputs([given.output], files_named(*given.controllers, *given.scenarios))
        runs = compare(
            given.controllers,
            given.scenarios,
            range(given.first_seed, given.first_seed + given.seeds),
            given.optimizer,
            lambda name: print(f"running {name}", file=sys.stderr, flush=True),
            **{name: value for name in OPTIONS if (value := getattr(given, name)) is not None},
        )
        if given.output is not None:
            write_atomically(given.output, runs.as_csv())
        print(runs.table(given.price))
        if given.output is not None:
            print(f"all runs: {given.output}")


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter, allow_abbrev=False
    )
    parser.add_argument(
        "controllers",
        nargs="+",
        metavar="CONTROLLER",
        help="names of controllers, e.g. spsfa-tip learned:runs/mine/best.safetensors@1; differences are to "
        "the first",
    )
    parser.add_argument(
        "--scenarios",
        nargs="+",
        default=list(CASES),
        metavar="NAME",
        help="names of scenarios, e.g. case1 rooms:0-9; default: %(default)s",
    )
    parser.add_argument("--seeds", type=int, default=20, help="number of seeds; default: %(default)s")
    parser.add_argument("--first-seed", type=int, default=0, help="the first seed; default: %(default)s")
    parser.add_argument(
        "--optimizer", default="firefly", metavar="NAME", help="optimizer to control; default: %(default)s"
    )
    parser.add_argument("--encoding", metavar="NAME", help="meaning of a member's numbers, e.g. bezier")
    parser.add_argument("--source", metavar="NAME", help="where new members come from, e.g. smooth")
    parser.add_argument("--cost", metavar="NAME", help="cost of flights over terrain, metabox or documented")
    parser.add_argument("--iterations", type=int, metavar="N", help="number of iterations of an episode")
    parser.add_argument("--max-evaluations", type=int, metavar="N", help="evaluation budget of an episode")
    parser.add_argument(
        "--price",
        type=float,
        default=1.0,
        help="price of 100,000 evaluations, in per cent of the optimum; default: %(default)s",
    )
    parser.add_argument(
        "--output", type=Path, metavar="FILE", help="CSV file for all runs; by default none is written"
    )
    return parser


if __name__ == "__main__":
    main()

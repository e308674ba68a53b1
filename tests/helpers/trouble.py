"""Hold the package against the oracle on random trouble: `python -m tests.helpers.trouble --number 100`.

The command prints what is wrong, scene by scene, and a summary. A run goes on from any seed, so thousands of
scenes can be held in parts. Plans and swarms take most of the time, so only every few scenes have them.
"""

import argparse
import multiprocessing
import sys
from pathlib import Path

if __package__ == "tests.helpers":  # else pytest has both folders on its path
    sys.path[:0] = [str(Path(__file__).parents[2]), str(Path(__file__).parents[1])]

PLANNED, GRIDS, SWARMS = 10, 5, 10  # every so many scenes have a plan, a grid, a swarm
WORDS = ("scenes", "grids", "paths")


def hold(job):
    """Return the outcome of a kind of trouble, one of `WORDS`, on a seed."""
    from helpers.trouble_grids import hold_grid
    from helpers.trouble_paths import Count, hold_optimised_paths, hold_random_paths, hold_slope
    from helpers.trouble_plans import hold_seed

    what, seed = job
    if what == "scenes":
        return hold_seed(seed, planned=seed % PLANNED == 0)
    if what == "grids":
        return hold_grid(seed)
    count = hold_random_paths(seed) + hold_slope(seed)
    return count + (hold_optimised_paths(seed) if seed % SWARMS == 0 else Count())


def main(arguments=None):
    """Run the command; return 0 if nothing is wrong, else 1."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--first", type=int, default=0, help="first seed (default: 0)")
    parser.add_argument("--number", type=int, default=100, help="number of seeds (default: 100)")
    parser.add_argument(
        "--processes", type=int, default=1, help="processes that share the seeds (default: 1)"
    )
    parser.add_argument(
        "--what", nargs="+", choices=WORDS, default=WORDS, help="kinds of trouble (default: all)"
    )
    parser.add_argument("--quiet", action="store_true", help="print the summary alone")
    options = parser.parse_args(arguments)
    return max([_run(what, options) for what in options.what])


def _run(what, options):
    from helpers.trouble_paths import Count
    from helpers.trouble_plans import summarise

    seeds = range(options.first, options.first + options.number)
    jobs = [(what, seed) for seed in seeds if what != "grids" or seed % GRIDS == 0]
    outcomes = []
    with multiprocessing.get_context("spawn").Pool(options.processes) as pool:
        for outcome in pool.imap(hold, jobs, chunksize=4):
            outcomes.append(outcome)
            if what != "paths" and outcome.faults and not options.quiet:
                print(outcome, flush=True)
    if what == "paths":
        total = sum(outcomes, Count())
        print(f"{what}: seeds {options.first} to {seeds[-1]}\n{total}\n", flush=True)
        return int(bool(total.wrong))
    print(f"{what}: seeds {options.first} to {seeds[-1]}\n{summarise(outcomes)}\n", flush=True)
    return int(any(one.faults for one in outcomes))


if __name__ == "__main__":
    sys.exit(main())

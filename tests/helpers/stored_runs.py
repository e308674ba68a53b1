"""Made-up runs, databases of runs, and what tables and figures show of them."""

import dataclasses
from contextlib import closing, contextmanager

import numpy as np


def cells_of(tables, name):
    """Return the rows of the table of that name, as dictionaries of printed texts by column."""
    (found,) = [table for table in tables if table.name == name]
    return [dict(zip(found.columns, row, strict=True)) for row in printed_rows(found)]


def printed_rows(table):
    """Return the rows of a table as tuples of printed texts."""
    return [tuple(map(str, row)) for row in table.rows]


def line(axes, label):
    """Return the coordinates of the line with that label, (2, points)."""
    (found,) = [each for each in axes.lines if each.get_label() == label]
    return np.array(found.get_data(), dtype=float)


def stored_run(key, courses, rows=None, **values):
    """Return a run with these courses in its trace; the other columns are 0, and values have defaults.

    `courses` has arrays by column of the trace, or is the whole trace, (rows, columns).
    """
    from experiments.runs.run import Run  # these imports take seconds
    from swarm_gym.history import HISTORY

    trace = courses
    if isinstance(courses, dict):
        trace = np.zeros((rows or max(map(len, courses.values()), default=1), len(HISTORY)))
        for name, course in courses.items():
            trace[:, HISTORY.index(name)] = course
    spent = np.nanmax(trace[:, HISTORY.index("evaluations")])  # NaN after a budget is spent
    usual = {"final_collision": 0.0, "evaluations": int(spent), "seconds": 0.1, "best_path": np.zeros((4, 2))}
    return Run(*key, trace=trace, provenance={}, **{**usual, **values})


def part_of(suite, controllers, scenarios, num_seeds, **changes):
    """Return a suite of some controllers, scenarios and seeds from 0 on."""
    some = {"controllers": tuple(controllers), "scenarios": tuple(scenarios), "num_seeds": num_seeds}
    return dataclasses.replace(suite, **some, first_seed=0, **changes)


def outcomes_of(gaps, load=None):
    """Outcomes with these gaps, a list by controller and scenario; evaluations are 1000 per controller."""
    from experiments.runs.outcomes import Outcomes
    from swarm_gym.reference import known_optimum
    from swarm_gym.worlds import make_problem

    controllers = tuple(dict.fromkeys(controller for controller, _ in gaps))
    scenarios = tuple(dict.fromkeys(scenario for _, scenario in gaps))
    optima = [known_optimum(make_problem(name)) for name in scenarios]
    gap = np.array([[gaps[c, s] for s in scenarios] for c in controllers])
    fitness = np.array(optima)[:, None] * (1.0 + gap)
    spent = np.ones_like(gap) * 1000.0 * (1.0 + np.arange(len(controllers)))[:, None, None]
    loading = {} if load is None else {"load": load}
    return Outcomes(controllers, scenarios, fitness, np.zeros_like(gap), spent, np.ones_like(gap), **loading)


@contextmanager
def filled_database(folder, runs):
    """Open a new database with these runs, and close it."""
    from experiments.runs.database import Results

    with closing(Results(folder / "made.sqlite")) as database:
        database.add(*runs)
        yield database


def make_database(path, suite, backend=None):
    """Make the database of a suite with all of its runs, by a backend or in this process; return its path."""
    from agents.backends.local import LocalBackend
    from experiments.runs.configuration import configuration
    from experiments.runs.database import Results
    from experiments.runs.runner import run_missing

    with closing(Results(path, configuration(suite))) as results:
        run_missing(suite, results, backend or LocalBackend(1))
    return path

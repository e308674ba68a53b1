"""A small suite with every kind of member, and its database, for tests of reports."""

from experiments.results import Results
from experiments.runner import configuration, run_missing
from experiments.suite import Suite

SUITE = Suite(
    name="tiny",
    controllers=("fixed:8", "spsfa-tip", "spsfa"),
    scenarios=("case1", "random-fields:test:0"),
    num_seeds=3,
    baseline="spsfa-tip",
    options={"iterations": 12},
    replayed=("spsfa-tip", "spsfa"),
)


def make_database(path, suite=SUITE):
    results = Results(path, configuration(suite))
    run_missing(suite, results, jobs=1)
    results.close()
    return path

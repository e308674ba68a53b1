"""A small suite with every kind of scenario and controller, for tests of reports."""

from experiments.runs.suite import Suite

SUITE = Suite(
    name="tiny",
    controllers=("fixed:8", "spsfa-tip", "spsfa"),
    scenarios=("case1", "random-fields:test:0"),
    num_seeds=3,
    baseline="spsfa-tip",
    options={"iterations": 12},
    replayed=("spsfa-tip", "spsfa"),
)

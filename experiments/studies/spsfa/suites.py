"""Suites of the SPSFA paper: its three cases, and its studies of single parameters."""

from pathlib import Path

from experiments.runs.claims import claims_of
from experiments.runs.suite import SPSFA_TABLES, Suite
from experiments.studies.controllers import CASES, FIXED_SIZES
from experiments.studies.spsfa import parameters

PAPER = Suite(
    name="paper",
    controllers=(*FIXED_SIZES, "spsfa", "spsfa-tip", "random", "learned:three-cases/0@1"),
    scenarios=CASES,
    num_seeds=20,
    baseline="spsfa-tip",
    snapshots=(("spsfa-tip", "case1", 0, (0, 3, 10, 30, 60, 100)),),
    tables=(*SPSFA_TABLES, "claims"),
    claims=claims_of(Path(__file__).parent / "claims.toml", "paper"),
    replayed=("spsfa-tip", "learned:three-cases/0@1", "fixed:80", "spsfa"),
)

PARAMETERS = Suite(
    name="parameters",
    controllers=parameters.CONTROLLERS,
    scenarios=(parameters.SCENARIO,),
    num_seeds=20,
    baseline="spsfa-tip",
    tables=("parameters",),
    figures=("parameters",),
)

SUITES = (PAPER, PARAMETERS)

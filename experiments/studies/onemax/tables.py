"""The table that `python -m experiments.evaluate` makes of runs on bit strings."""

from experiments.tables.gaps import evaluation_tables

TABLES = {"evaluations": evaluation_tables}

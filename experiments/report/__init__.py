"""A results database as one page that one can explore and send on: `python -m experiments.report --help`."""

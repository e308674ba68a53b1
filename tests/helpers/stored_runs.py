"""Helpers for tests of results tables and of databases of runs."""


def cells_of(tables, name):
    """Return the rows of the table of that name, as dictionaries of printed texts by column."""
    (found,) = [table for table in tables if table.name == name]
    return [dict(zip(found.columns, row, strict=True)) for row in printed_rows(found)]


def printed_rows(table):
    """Return the rows of a table as tuples of printed texts."""
    return [tuple(map(str, row)) for row in table.rows]


def make_database(path, suite):
    """Make the database of a suite with all of its runs, in this process, and return its path."""
    from agents.backends.local import LocalBackend  # these imports take seconds
    from experiments.runs.database import Results
    from experiments.runs.runner import configuration, run_missing

    results = Results(path, configuration(suite))
    run_missing(suite, results, LocalBackend(1))
    results.close()
    return path

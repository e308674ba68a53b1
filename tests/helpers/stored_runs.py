"""What tests of tables share, which are made of stored runs."""


def cells_of(tables, name):
    """The rows of the table of that name, as dictionaries of what stands in each column."""
    (found,) = [table for table in tables if table.name == name]
    return [dict(zip(found.columns, row, strict=True)) for row in found.rows]


def make_database(path, suite):
    """The database of a suite with all of its runs, made in this process."""
    from agents.backends.local import LocalBackend  # these imports take seconds
    from experiments.runs.database import Results
    from experiments.runs.runner import configuration, run_missing

    results = Results(path, configuration(suite))
    run_missing(suite, results, LocalBackend(1))
    results.close()
    return path

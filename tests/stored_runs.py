"""What tests of tables share, which are made of stored runs."""


def cells_of(tables, name):
    """The rows of the table of that name, as dictionaries of what stands in each column."""
    (found,) = [table for table in tables if table.name == name]
    return [dict(zip(found.columns, row, strict=True)) for row in found.rows]

"""Parts of tables, for documents that have no room for all of one."""

from experiments.tables.table import Table

SETS = "scenarios"  # the column of the sets of scenarios
NOTHING = "–"


def select(table: Table, columns: tuple[str, ...]) -> Table:
    """The table with these columns, in this order.

    Raises:
        ValueError: if it lacks one.
    """
    places = [_place(table, column) for column in columns]
    rows = [tuple(row[place] for place in places) for row in table.rows]
    return Table(table.name, table.caption, columns, rows)


def split(table: Table, column: str = SETS) -> dict[str, Table]:
    """A table for each value of a column, without it, in the order that the values come in."""
    place = _place(table, column)
    rest = tuple(name for name in table.columns if name != column)
    found = {}
    for value in dict.fromkeys(row[place] for row in table.rows):
        rows = [row for row in table.rows if row[place] == value]
        found[value] = select(Table(table.name, table.caption, table.columns, rows), rest)
    return found


def spread(table: Table, keys: tuple[str, ...], value: str, column: str = SETS) -> Table:
    """A row for each combination of the keys, and a column with the value for each entry of a column."""
    places = [_place(table, key) for key in keys]
    parts = split(table, column)
    cells = {
        (tuple(row[place] for place in places), row[_place(table, column)]): row[_place(table, value)]
        for row in table.rows
    }
    rows = [
        (*key, *(cells.get((key, part), NOTHING) for part in parts))
        for key in dict.fromkeys(key for key, _ in cells)
    ]
    return shorten_heads(Table(table.name, table.caption, (*keys, *parts), rows))


def join(table: Table, other: Table, keys: tuple[str, ...], value: str) -> Table:
    """The table with a column more, of another table's rows with the same keys."""
    values = {row[:-1]: row[-1] for row in select(other, (*keys, value)).rows}
    found = (values.get(key, NOTHING) for key in select(table, keys).rows)
    rows = [(*row, cell) for row, cell in zip(table.rows, found, strict=True)]
    return Table(table.name, table.caption, (*table.columns, value), rows)


def shorten_heads(table: Table) -> Table:
    """The table with `test` as the head of a column `random-fields:test`."""
    heads = tuple(column.rpartition(":")[2] for column in table.columns)
    return Table(table.name, table.caption, heads, table.rows)


def _place(table: Table, column: str) -> int:
    if column not in table.columns:
        raise ValueError(f"table {table.name!r} has no column {column!r}, but {', '.join(table.columns)}")
    return table.columns.index(column)

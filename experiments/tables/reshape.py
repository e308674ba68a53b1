"""Parts of results tables, for documents that have no room for a whole table."""

from collections.abc import Collection, Sequence
from dataclasses import replace

from experiments.tables.cell import MISSING, Entry
from experiments.tables.table import Table

SETS = "scenarios"  # head of the column with the sets of scenarios


def select(table: Table, columns: tuple[str, ...]) -> Table:
    """Return the table with these columns, in this order.

    Raises:
        ValueError: if the table lacks one of them.
    """
    places = [_place(table, column) for column in columns]
    rows = [tuple(row[place] for place in places) for row in table.rows]
    return replace(table, columns=columns, rows=rows)


def pick(table: Table, columns: tuple[str, ...], keys: Sequence[tuple[str, ...]]) -> Table:
    """Return the table with one row for each key, in the order of the keys.

    Args:
        table: table to take rows from.
        columns: heads of the columns that name a row.
        keys: entries of these columns, one tuple for each row.

    Raises:
        ValueError: if the table lacks a column or a row.
    """
    places = [_place(table, column) for column in columns]
    by_key = {tuple(str(row[place]) for place in places): row for row in table.rows}
    missing = [", ".join(key) for key in keys if key not in by_key]
    if missing:
        raise ValueError(f"table {table.name!r} has no rows of {'; '.join(missing)}")
    return replace(table, rows=[by_key[key] for key in keys])


def keep_rows(table: Table, names: Collection[str]) -> Table:
    """Return the table with the rows whose first entry is one of the names, in the order of the table.

    Raises:
        ValueError: if the table lacks one of the rows.
    """
    rows = [row for row in table.rows if str(row[0]) in names]
    if missing := sorted(set(names) - {str(row[0]) for row in rows}):
        raise ValueError(f"table {table.name!r} has no rows of {'; '.join(missing)}")
    return replace(table, rows=rows)


def split(table: Table, column: str = SETS) -> dict[str, Table]:
    """Return a table for each entry of a column, without this column, in the order of the entries."""
    place = _place(table, column)
    rest = tuple(name for name in table.columns if name != column)
    found = {}
    for value in dict.fromkeys(str(row[place]) for row in table.rows):
        rows = [row for row in table.rows if str(row[place]) == value]
        found[value] = select(replace(table, rows=rows), rest)
    return found


def spread(table: Table, keys: tuple[str, ...], value: str, column: str = SETS) -> Table:
    """Return a table with a row for each combination of the keys, and a column for each entry of a column.

    Args:
        table: table to reshape.
        keys: heads of the columns that name a row.
        value: head of the column whose entries fill the new columns.
        column: head of the column whose entries become the heads of the new columns.
    """
    places = [_place(table, key) for key in keys]
    parts = split(table, column)
    cells: dict[tuple[tuple[str, ...], str], Entry] = {
        (tuple(str(row[place]) for place in places), str(row[_place(table, column)])): row[
            _place(table, value)
        ]
        for row in table.rows
    }
    rows = [
        (*key, *(cells.get((key, part), MISSING) for part in parts))
        for key in dict.fromkeys(key for key, _ in cells)
    ]
    return shorten_heads(replace(table, columns=(*keys, *parts), rows=rows))


def join(table: Table, other: Table, keys: tuple[str, ...], value: str) -> Table:
    """Return the table with one more column, taken from the rows of another table with the same keys."""
    values = {tuple(map(str, row[:-1])): row[-1] for row in select(other, (*keys, value)).rows}
    found = (values.get(tuple(map(str, key)), MISSING) for key in select(table, keys).rows)
    rows = [(*row, cell) for row, cell in zip(table.rows, found, strict=True)]
    return replace(table, columns=(*table.columns, value), rows=rows)


def shorten_heads(table: Table) -> Table:
    """Return the table with `test` as the head of a column `random-fields:test`."""
    return replace(table, columns=tuple(column.rpartition(":")[2] for column in table.columns))


def _place(table: Table, column: str) -> int:
    if column not in table.columns:
        raise ValueError(f"table {table.name!r} has no column {column!r}, but {', '.join(table.columns)}")
    return table.columns.index(column)

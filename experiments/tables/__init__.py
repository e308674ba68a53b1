"""Results tables: cells with numbers, their renderings, and tables that several studies have."""

from experiments.tables.table import Table

__all__ = ["Table"]

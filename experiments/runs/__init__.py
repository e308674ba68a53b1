"""Suites, their runs, and the database that stores these."""

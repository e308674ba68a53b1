"""Suites and runs: what is run, how, and the database that keeps it."""

"""Suites of runs, their results, and the tables and figures made from them."""

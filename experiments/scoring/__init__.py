"""Scores that one can check: suites with few seeds, rows of scores, claims about policies and their checks."""

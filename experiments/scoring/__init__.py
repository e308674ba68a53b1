"""Scores that one can check: suites with few seeds, rows of scores, submissions and claims."""

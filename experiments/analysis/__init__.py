"""Analyses of controllers that go beyond the runs of a suite."""

"""Analyses of controllers that need more than the stored runs of a suite."""

"""Tuning of hand-designed controllers; started by `python -m agents.tune`."""

"""Tuning of hand-designed controllers and open loops; `python -m agents.tune` starts it."""

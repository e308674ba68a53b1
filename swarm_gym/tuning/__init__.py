"""Tuning of hand-designed controllers and open loops; `swarm-gym tune` starts it."""

"""Measurements of what backends add to the work, and predictions for clusters."""

"""Scenarios whose map changes during an episode."""

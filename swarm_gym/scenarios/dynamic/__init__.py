"""Scenarios whose maps change during an episode, or whose robots drive during it."""

"""Bit strings that are known by their number of ones."""

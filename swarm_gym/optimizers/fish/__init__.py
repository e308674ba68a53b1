"""Artificial fish swarms: the standard, the improved and the hybrid algorithm."""

"""Readers of map files in public formats."""

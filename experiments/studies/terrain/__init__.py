"""Swarms over terrain: which optimizer, encoding and source of members finds flights of small cost."""

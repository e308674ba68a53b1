"""Readers of map files in public formats, and the families of scenarios on these maps."""

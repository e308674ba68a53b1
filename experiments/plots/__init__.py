"""Figures: their style and the kinds that several studies share."""

"""Figures that several studies share, their style, the gallery and videos."""

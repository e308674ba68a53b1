"""The 24 BBOB functions: where their minima lie, how they are rotated, and their scenarios."""

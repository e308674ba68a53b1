"""Measurements of speed for `experiments.benchmark`: one module for each group of quantities."""

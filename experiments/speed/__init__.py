"""What `experiments.benchmark` measures: one file per group of quantities."""

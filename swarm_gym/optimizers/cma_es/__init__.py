"""CMA-ES: its state, its weights and rates, the square root of a covariance, and when it has stalled."""

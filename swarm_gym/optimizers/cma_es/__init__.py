"""CMA-ES: state, weights and rates, sampling, learning, eigenvectors, and signs that it has stalled."""

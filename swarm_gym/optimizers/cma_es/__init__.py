"""CMA-ES: state, weights and rates, sampling, learning, movement, eigenvectors, and signs of stalling."""

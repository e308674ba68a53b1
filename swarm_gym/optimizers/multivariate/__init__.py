"""The multivariate optimization algorithm and its table of regions."""

"""Exact expected runtimes of the (1 + (lambda, lambda)) genetic algorithm on OneMax, and the optimal control."""

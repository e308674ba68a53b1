"""Expected runtimes of the (1 + (lambda, lambda)) genetic algorithm on OneMax, and its optimal control."""

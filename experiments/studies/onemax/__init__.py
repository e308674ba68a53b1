"""The study of the (1 + (lambda, lambda)) genetic algorithm on OneMax, whose optimal control is known."""

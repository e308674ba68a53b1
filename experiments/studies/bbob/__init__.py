"""The study of rules of the population size on the BBOB functions, at equal budgets of evaluations."""

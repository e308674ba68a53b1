"""The study of rules of the population size on optimizers that other libraries keep."""

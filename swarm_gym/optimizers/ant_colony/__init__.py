"""Ant colony optimization on grids: the colony, an ant's walk and the pheromone trails."""

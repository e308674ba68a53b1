"""Flights over terrain: height maps with threats, an altitude band and limits on turns and climbs."""

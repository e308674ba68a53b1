"""Flights over terrain: waypoints above ground, between threats, in an altitude band."""

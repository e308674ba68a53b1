"""Observers that decide in the states of another controller, and controllers with masked inputs."""

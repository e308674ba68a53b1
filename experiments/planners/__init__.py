"""The swarms beside planners that people use, on public and generated grid maps."""

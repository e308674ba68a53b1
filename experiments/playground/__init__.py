"""A playground in a browser: a reader steers a swarm beside the schedule and a learned policy."""

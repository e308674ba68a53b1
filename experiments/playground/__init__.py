"""A playground in a browser: a swarm that a reader steers by hand, beside the schedule and a learned policy."""

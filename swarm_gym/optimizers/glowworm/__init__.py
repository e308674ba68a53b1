"""The glowworm swarm: glow, neighbours, members and trajectory of the robot."""

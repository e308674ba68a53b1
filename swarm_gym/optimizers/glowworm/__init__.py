"""The glowworm swarm: glow, neighbours, members and the robot's trajectory."""

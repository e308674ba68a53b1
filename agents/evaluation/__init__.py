"""Episodes of controllers: rollouts, observers that decide in the same states, and masked inputs."""

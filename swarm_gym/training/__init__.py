"""Training of policies: options, runs, learners TensorBoard events; `swarm-gym train` starts it."""

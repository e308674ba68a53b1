"""Training of policies: options, runs, learners and TensorBoard events."""

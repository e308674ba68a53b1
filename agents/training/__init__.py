"""Training of policies: options, runs, learners and what TensorBoard shows."""

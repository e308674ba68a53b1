"""The study of the paper of Brand and Yu."""

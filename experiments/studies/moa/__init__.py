"""The study of the MOA paper."""

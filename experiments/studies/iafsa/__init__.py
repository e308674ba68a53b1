"""The study of the IAFSA paper."""

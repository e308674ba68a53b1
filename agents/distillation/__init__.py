"""Distillation: rules with few numbers, fitted to the decisions of a trained policy."""

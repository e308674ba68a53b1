"""Exact geometry that problems of several kinds share."""

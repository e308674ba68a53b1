"""Tasks of published studies, one module for each paper."""

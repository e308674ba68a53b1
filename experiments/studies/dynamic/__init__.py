"""The study of maps that change."""

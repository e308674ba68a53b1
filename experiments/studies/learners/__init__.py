"""The study of what plain learners of other libraries reach."""

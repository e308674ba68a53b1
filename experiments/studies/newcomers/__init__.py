"""The study of new members drawn as smooth bends."""

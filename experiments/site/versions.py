"""Versions of the environments, as their pages list them; docs/versions.md has the rule."""

# By version, the release that brought it and what is new in it. They hold for every environment.
VERSIONS = {"v0": ("0.1.0", "The first version.")}

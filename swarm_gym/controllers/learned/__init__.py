"""Learned controllers: policy files, their manifests and networks."""

"""The documentation site: pages that are generated from the code, and the check of its links."""

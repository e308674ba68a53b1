"""Reports of results databases, HTML files to explore and to share: `python -m experiments.report --help`."""

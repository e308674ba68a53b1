"""One folder for each study: its suites, published numbers, tables and figures."""

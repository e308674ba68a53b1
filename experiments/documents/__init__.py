"""Pages and documents that show tables and figures."""

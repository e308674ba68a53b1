"""Problems without a map: the minimum of a test function."""

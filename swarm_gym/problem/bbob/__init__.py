"""Problems without a map: the least value of a BBOB function."""

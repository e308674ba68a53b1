"""Problems of walking over a grid map, for optimizers whose members are points."""

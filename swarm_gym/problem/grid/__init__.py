"""Problems on occupancy grids: Bezier curves or waypoints among blocked cells."""

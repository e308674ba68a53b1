"""Problems on maps of circles and convex polygons: waypoints beside the start-target line."""

"""Problems on maps of circles and convex polygons: waypoints next to the start-target line."""

"""Obstacles as shapes of shapely, for checks of geometry by other code."""

import shapely

from swarm_gym.scenarios import Circle


def shape(obstacle, quad_segs=32):
    """Return the shape of an obstacle; a circle is a polygon of so many segments per quarter."""
    if isinstance(obstacle, Circle):
        return shapely.Point(obstacle.x, obstacle.y).buffer(obstacle.radius, quad_segs=quad_segs)
    return shapely.Polygon(obstacle.vertices)

"""A check of drivable curves by NumPy and shapely alone: points a small step apart, and their chords."""

import numpy as np
import shapely

from swarm_gym.scenarios import Circle, GridScenario

SHORT = 1e-5  # chords that are left out: their directions are little known
ROUNDING = 1e-7  # of angles between chords
CHUNK = 200  # points of a piece of the line


def obstacles_of(scenario):
    """Return the obstacles of a map as shapes of shapely."""
    if isinstance(scenario, GridScenario):
        rows, columns = np.nonzero(scenario.map.blocked)
        middles = scenario.map.to_map(np.stack([columns, rows], axis=-1))
        half = scenario.map.resolution / 2.0
        return shapely.box(*(middles - half).T, *(middles + half).T)
    return np.array(
        [
            shapely.Point(one.x, one.y).buffer(one.radius, quad_segs=512)
            if isinstance(one, Circle)
            else shapely.Polygon(one.vertices)
            for one in scenario.obstacles
        ]
    )


def assert_drivable(found, robot_radius, start_heading=None, goal_heading=None, reverses=False, step=0.001):
    """Assert that the curve of a plan obeys all limits, at points a step apart in map units."""
    curve, scenario = found.curve, found.map
    poses = curve.sampled(step)
    points = poses[:, :2]
    np.testing.assert_allclose(points[[0, -1]], [scenario.start, scenario.target], atol=1e-6)
    chords = np.diff(points, axis=0)
    lengths = np.hypot(*chords.T)
    assert lengths.max() <= step * (1.0 + 1e-9)
    np.testing.assert_allclose(lengths.sum(), found.length, rtol=1e-5)
    kept = lengths > SHORT
    chords, lengths, signs = chords[kept], lengths[kept], poses[:-1, 4][kept]
    forwards = chords * signs[:, None]  # where the robot looks to
    angles = np.arctan2(forwards[:, 1], forwards[:, 0])
    turns = np.abs((np.diff(angles) + np.pi) % (2.0 * np.pi) - np.pi)
    most = 0.5 * (lengths[1:] + lengths[:-1]) + SHORT
    assert (turns <= most * (1.0 + 1e-3) / curve.turning_radius + ROUNDING).all()
    claimed = np.radians(poses[:-1, 2][kept])
    off = np.abs((angles - claimed + np.pi) % (2.0 * np.pi) - np.pi)
    assert (off <= 0.5 * step / curve.turning_radius + 1e-6).all()
    assert reverses or (signs == 1.0).all()
    for heading, place in ((start_heading, 0), (goal_heading, -1)):
        if heading is not None:
            assert abs((poses[place, 2] - heading + 180.0) % 360.0 - 180.0) < 1e-4
    lines = [shapely.LineString(points[k : k + CHUNK + 1]) for k in range(0, len(points) - 1, CHUNK)]
    _, apart = shapely.STRtree(obstacles_of(scenario)).query_nearest(lines, return_distance=True)
    assert apart.min(initial=np.inf) >= robot_radius - 1e-9
    if np.isfinite(found.clearance):  # it is unknown of plans that were stopped
        assert abs(apart.min() - found.clearance) < 1e-3 * curve.turning_radius
    else:
        assert found.stopped or apart.size == 0

"""Random tasks of planning from seeds: the same obstacles for planners, as GeoJSON, and for an oracle.

A scene is drawn on a lattice of whole numbers, where the oracle works without rounding. It is then turned,
scaled and moved. If it is turned by a Gaussian integer and scaled by a power of two, planners get the scene
exactly.

Other scenes have rounded coordinates: walls that are shared in part have gaps of a last digit, or overlap.
There the lattice says what is right, so that such a gap is closed.
"""

import json
import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import shapely

from helpers.trouble_shapes import KINDS, SIZE, random_discs
from oracles.entered_depth import NO_DISCS, Blocked
from swarm_gym.errors import ScenarioError
from swarm_gym.scenarios import Circle, Polygon, Scenario

OFFSETS = (0j, 0j, 400_000 + 5_000_000j, 1e7 + 1e7j, -72_123 + 33j)
CLOSED = 1e-13  # gap over extent that counts as closed
FARTHEST = 1e6  # offset over extent: rounded coordinates are a hundred times finer than 1e-9 of the extent
TURNS = (1 + 0j, 1 + 0j, 1j, -1 + 0j)
PYTHAGOREAN = (3 + 4j, -4 + 3j, 5 - 12j, 8 + 15j)  # of whole length, so that turned discs are exact
ROOM = 1.02  # distance of ends from obstacles, over the robot's radius


@dataclass(frozen=True, eq=False)
class Scene:
    """A task of planning among polygons and discs.

    Attributes:
        seed: seed that the scene was drawn from.
        kind: kind of the obstacles, a key of `KINDS`.
        exact: whether coordinates are exact, so that obstacles touch as on the lattice.
        polygons: polygons on the lattice.
        discs: (k, 3) centres and radii on the lattice.
        start: start on the lattice, as a complex number.
        goal: goal on the lattice, as a complex number.
        lattice_radius: radius of the robot on the lattice.
        turn: factor from the lattice to map units, as a complex number.
        offset: map coordinates of the origin of the lattice, as a complex number.
    """

    seed: int
    kind: str
    exact: bool
    polygons: list[shapely.Polygon]
    discs: np.ndarray
    start: complex
    goal: complex
    lattice_radius: float
    turn: complex
    offset: complex

    @property
    def scale(self):
        """Map units per unit of the lattice."""
        return abs(self.turn)

    @property
    def radius(self):
        """Radius of the robot in map units."""
        return self.lattice_radius * self.scale

    @cached_property
    def ends(self):
        """Start and goal, (x, y) in map units."""
        return tuple(
            tuple(self.place(np.array([[z.real, z.imag]]))[0].tolist()) for z in (self.start, self.goal)
        )

    @cached_property
    def lattice(self):
        """The obstacles on the lattice, without growth."""
        return Blocked(shapely.union_all(self.polygons), self.discs)

    def grown_lattice(self, factor=1.0):
        """Return the obstacles on the lattice for a robot, with its radius times a factor."""
        return Blocked(self.lattice.area, self.discs, factor * self.lattice_radius)

    @cached_property
    def blocked(self):
        """The grown obstacles, with the very coordinates that planners get, moved by the offset.

        Gaps of a last digit count as closed: rounded coordinates are united on a fine grid.
        """
        placed = [shapely.transform(one, lambda p: self.local(self.place(p))) for one in self.polygons]
        discs = self.discs * self.scale
        if len(discs):
            discs[:, :2] = self.local(self.place(self.discs[:, :2]))
        grid = None if self.exact else CLOSED * 2.0 * SIZE * self.scale
        return Blocked(shapely.union_all(placed, grid_size=grid), discs, self.radius)

    def place(self, points):
        """Return map coordinates, (k, 2), of points of the lattice."""
        z = self.offset + self.turn * (points[:, 0] + 1j * points[:, 1])
        return np.stack([z.real, z.imag], axis=-1)

    def local(self, points):
        """Return map coordinates without the offset, (k, 2)."""
        return np.asarray(points) - np.array([self.offset.real, self.offset.imag])

    @cached_property
    def geojson(self):
        """The polygons as the text of a GeoJSON file, or None if there are discs."""
        if len(self.discs):
            return None
        rng = np.random.default_rng([self.seed, 1])
        features = [
            {
                "type": "Feature",
                "properties": {},
                "geometry": {
                    "type": "Polygon",
                    "coordinates": [self._ring(ring, rng) for ring in shapely.get_rings(one)],
                },
            }
            for one in self.polygons
        ]
        return json.dumps({"type": "FeatureCollection", "features": features})

    @cached_property
    def scenario(self):
        """The scenario of all obstacles, or None if a polygon is not convex."""
        try:
            obstacles = [
                Polygon(tuple(map(tuple, self.place(_corners(one)).tolist()))) for one in self.polygons
            ]
        except ScenarioError:
            return None
        if any(len(one.interiors) for one in self.polygons):
            return None
        if len(self.discs):
            centres = self.place(self.discs[:, :2]).tolist()
            radii = (self.discs[:, 2] * self.scale).tolist()
            obstacles += [Circle(x, y, r) for (x, y), r in zip(centres, radii, strict=True)]
        around = 4.0 * SIZE * self.scale
        every = np.concatenate([self.place(_corners(one)) for one in self.polygons] + [np.array(self.ends)])
        low, high = every.min(axis=0) - around, every.max(axis=0) + around
        return Scenario(f"trouble:{self.seed}", *self.ends, tuple(obstacles), (*low.tolist(), *high.tolist()))

    def _ring(self, ring, rng):
        """Return the closed ring as a list of points, from any corner, in any direction."""
        points = shapely.get_coordinates(ring)[:-1]
        if self.exact and rng.random() < 0.2:
            # Straight corners; the lattice is even before it is turned, so that they are exact.
            points = np.stack([points, (points + np.roll(points, -1, axis=0)) / 2], axis=1).reshape(-1, 2)
        points = np.roll(points, rng.integers(len(points)), axis=0)[:: rng.choice([-1, 1])]
        placed = self.place(points).tolist()
        return [*placed, placed[0]]


def make_scene(seed, *, convex=False, radius=True, placed=True):
    """Draw a scene.

    Args:
        seed: seed of everything.
        convex: whether polygons must be convex, so that the scene has a scenario.
        radius: whether the robot may have a radius.
        placed: whether offset and scale may be anything; else the map is some hundreds wide, at the origin.
    """
    rng = np.random.default_rng([seed, 0])
    while True:
        kind = str(rng.choice(list(KINDS)))
        draw, points_touch = KINDS[kind]
        polygons = [shapely.transform(one, lambda points: 2.0 * points) for one in draw(rng)]
        discs = 2.0 * random_discs(rng) if rng.random() < 0.25 else NO_DISCS
        if len(discs) or convex:
            polygons = [part for one in polygons for part in _convex_parts(one)]
        chosen = float(rng.uniform(0.005, 0.04) * 2 * SIZE) if radius and rng.random() < 0.4 else 0.0
        lattice = Blocked(shapely.union_all(polygons), discs)
        ends = _ends(rng, polygons, lattice, chosen)
        if ends is not None:
            break
    rounded = not points_touch and not len(discs) and rng.random() < 0.25
    turn, offset = _placement(rng, rounded, len(discs) > 0, placed)
    return Scene(seed, kind, not rounded, polygons, discs, *ends, chosen, turn, offset)


def shared_edges(scene):
    """Return edges, pairs of complex points of the lattice, that two polygons share inside the union."""
    found = []
    for k, one in enumerate(scene.polygons):
        for other in scene.polygons[:k]:
            common = shapely.intersection(one.boundary, other.boundary)
            for part in shapely.get_parts(common):
                if part.geom_type == "LineString" and part.length > 0.0:
                    a, b = shapely.get_coordinates(part)[[0, -1]] @ np.array([1.0, 1j])
                    if scene.lattice.points_inside(np.array([(a + b) / 2]))[0]:
                        found.append((a, b))
    return found


def _ends(rng, polygons, lattice, radius):
    """Draw start and goal outside of everything, often on the boundary or in line with a shared edge."""
    (x0, y0), (x1, y1) = lattice.around
    low, high = np.array([x0, y0]).astype(int) - 16, np.array([x1, y1]).astype(int) + 16
    grown = Blocked(lattice.area, lattice.discs, ROOM * radius)
    for attempt in range(60):
        pair = [complex(*rng.integers(low, high)) for _ in range(2)]
        if radius == 0.0 and rng.random() < 0.3:
            ring = _corners(polygons[rng.integers(len(polygons))])
            k = rng.integers(len(ring))
            at = ring[k] if rng.random() < 0.5 else (ring[k] + ring[k - 1]) / 2
            pair[rng.integers(2)] = complex(*at)
        elif rng.random() < 0.3:
            ring = _corners(polygons[rng.integers(len(polygons))])
            k = rng.integers(len(ring))
            a, b = complex(*ring[k]), complex(*ring[k - 1])
            pair = [a + (a - b), b - (a - b)]
        if abs(pair[0] - pair[1]) < 0.3 * lattice.extent or grown.points_inside(np.array(pair)).any():
            continue
        if attempt > 40 or lattice.segments_inside(*np.array(pair)[:, None])[0]:
            return pair
    return None


def _placement(rng, rounded, has_discs, placed):
    """Draw the factor from the lattice to map units, and the offset."""
    extent = 10.0 ** rng.uniform(-3.0, 7.0) if placed else rng.uniform(300.0, 1500.0)
    if rounded:
        turn = np.exp(1j * rng.uniform(0.0, math.tau)) * extent / (2 * SIZE)
    else:
        turns = [
            *TURNS,
            *(PYTHAGOREAN if has_discs else [complex(*rng.integers(1, 10, 2)) for _ in range(4)]),
        ]
        turn = turns[rng.integers(len(turns))]
        turn *= 2.0 ** round(math.log2(extent / (2 * SIZE * abs(turn))))
    if not placed:
        return complex(turn), 0j
    wished = OFFSETS[rng.integers(len(OFFSETS))] * min(1.0, FARTHEST * abs(turn) * SIZE / 1e7)
    unit = 2.0 ** math.floor(math.log2(abs(turn) / 32))
    return complex(turn), complex(round(wished.real / unit) * unit, round(wished.imag / unit) * unit)


def _corners(polygon):
    return shapely.get_coordinates(polygon.exterior)[:-1]


def _convex_parts(polygon):
    """Return the polygon if it is convex, else triangles of it."""
    points = _corners(polygon)
    before, after = points - np.roll(points, 1, axis=0), np.roll(points, -1, axis=0) - points
    turns = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]
    if not len(polygon.interiors) and ((turns > 0.0).all() or (turns < 0.0).all()):
        return [polygon]
    return list(shapely.get_parts(shapely.constrained_delaunay_triangles(polygon)))

"""Random obstacles that trouble planners, with whole coordinates, so that they touch exactly.

Each function draws polygons of shapely with whole coordinates in [0, SIZE], or near it.
"""

import math
from itertools import pairwise

import numpy as np
import shapely

SIZE = 48
LETTERS = {
    "L": [(0, 0, 1, 3), (0, 0, 3, 1)],
    "T": [(0, 2, 3, 3), (1, 0, 2, 3)],
    "U": [(0, 0, 3, 1), (0, 0, 1, 3), (2, 0, 3, 3)],
    "H": [(0, 0, 1, 3), (2, 0, 3, 3), (0, 1, 3, 2)],
    "plus": [(1, 0, 2, 3), (0, 1, 3, 2)],
    "Z": [(0, 0, 2, 1), (1, 0, 2, 3), (1, 2, 3, 3)],
}


def boxes(rng, number, most, least=1):
    """Draw rectangles, (x_min, y_min, x_max, y_max), with sides from `least` to `most`."""
    low = rng.integers(0, SIZE - least, (number, 2))
    return np.concatenate([low, low + rng.integers(least, most + 1, (number, 2))], axis=1)


def merged(rectangles):
    """Return the union of rectangles as polygons without straight corners."""
    union = shapely.union_all(shapely.box(*np.array(rectangles, dtype=float).T))
    return [one.simplify(0.0) for one in shapely.get_parts(union)]


def star(rng):
    """One star-shaped polygon, concave nearly always."""
    while True:
        angles = np.sort(rng.uniform(0.0, math.tau, rng.integers(5, 14)))
        radii = rng.uniform(0.2, 1.0, len(angles)) * SIZE / 2
        corners = np.round(SIZE / 2 + np.stack([radii * np.cos(angles), radii * np.sin(angles)], axis=-1))
        polygon = shapely.Polygon(corners)
        if polygon.is_valid and polygon.area > SIZE and not _has_straight_corner(polygon):
            return [polygon]


def comb(rng):
    """A comb: teeth of random lengths on a spine."""
    rectangles, x, thick = [], 0, rng.integers(1, 5)
    while x < SIZE - 8:
        tooth = rng.integers(1, 5)
        rectangles.append((x, 0, x + tooth, rng.integers(8, SIZE)))
        x += tooth + rng.integers(1, 7)
    return merged([*rectangles, (0, 0, x, thick)])


def spiral(rng):
    """A wall that turns inwards in right angles."""
    x0, y0, x1, y1 = 0, 0, SIZE, SIZE
    thick, gap, rectangles = int(rng.integers(1, 3)), int(rng.integers(3, 7)), []
    for _ in range(rng.integers(1, 4)):
        if min(x1 - x0, y1 - y0) < 3 * (thick + gap):
            break
        rectangles.append((x0, y0, x1, y0 + thick))
        rectangles.append((x1 - thick, y0, x1, y1))
        rectangles.append((x0 + thick + gap, y1 - thick, x1, y1))
        rectangles.append((x0 + thick + gap, y0 + thick + gap, x0 + 2 * thick + gap, y1))
        x0, y0, x1, y1 = x0 + thick + gap, y0 + thick + gap, x1 - thick - gap, y1 - thick - gap
    return merged(rectangles)


def letter(rng):
    """A thick letter with strokes of random widths."""
    x, y = (np.concatenate([[0], np.cumsum(rng.integers(2, SIZE // 3, 3))]) for _ in range(2))
    strokes = LETTERS[str(rng.choice(list(LETTERS)))]
    return merged([(x[a], y[b], x[c], y[d]) for a, b, c, d in strokes])


def terrace(rng):
    """A row of houses that share whole walls."""
    ends = np.concatenate([[0], np.cumsum(rng.integers(3, 14, rng.integers(2, 6)))])
    y = int(rng.integers(0, SIZE // 2))
    low, high = y, y + rng.integers(3, SIZE // 2)
    if rng.random() < 0.5:
        return [shapely.box(a, low, b, high) for a, b in pairwise(ends)]
    return [shapely.box(low, a, high, b) for a, b in pairwise(ends)]


def staggered(rng):
    """A block of houses that share parts of walls: rows with other ends."""
    houses, y = [], 0
    for _ in range(rng.integers(2, 4)):
        height, x = rng.integers(3, 12), rng.integers(0, 10)
        for _ in range(rng.integers(1, 4)):
            width = rng.integers(3, 14)
            houses.append(shapely.box(x, y, x + width, y + height))
            x += width + (rng.integers(1, 5) if rng.random() < 0.2 else 0)
        y += height
    return houses


def overlaps(rng):
    """Rectangles and convex polygons that overlap."""
    shapes = [shapely.box(*box) for box in boxes(rng, rng.integers(2, 7), SIZE // 2, 2).astype(float)]
    for _ in range(rng.integers(1, 5)):
        shapes.append(convex(rng, SIZE // 3))
    return shapes


def convex(rng, size):
    """Return a convex polygon of random lattice points, without straight corners."""
    while True:
        points = rng.integers(0, size + 1, (rng.integers(3, 9), 2)) + rng.integers(0, SIZE - size + 1, 2)
        hull = shapely.MultiPoint(points.astype(float)).convex_hull
        if hull.area > size and not _has_straight_corner(hull):
            return hull


def rooms(rng):
    """A floor with outer walls: rooms are holes, most with a door."""
    thick, columns, rows = int(rng.integers(1, 3)), int(rng.integers(1, 4)), int(rng.integers(1, 3))
    x = np.linspace(0, SIZE, columns + 1).round().astype(int)
    y = np.linspace(0, SIZE * 2 // 3, rows + 1).round().astype(int)
    floor = shapely.box(0, 0, x[-1] + thick, y[-1] + thick)
    free = []
    for i in range(columns):
        for j in range(rows):
            free.append((x[i] + thick, y[j] + thick, x[i + 1], y[j + 1]))
            if rng.random() < 0.7:
                wide, at = rng.integers(2, 5), rng.integers(2, 6)
                free.append((x[i] + thick + at, y[j], x[i] + thick + at + wide, y[j] + thick))
            if rng.random() < 0.5:
                wide, at = rng.integers(2, 5), rng.integers(2, 5)
                free.append((x[i], y[j] + thick + at, x[i] + thick, y[j] + thick + at + wide))
    left = floor.difference(shapely.union_all(shapely.box(*np.array(free, dtype=float).T)))
    return [one.simplify(0.0) for one in shapely.get_parts(left)]


def corners(rng):
    """Squares and triangles that touch at corners, or with a corner at the side of another one."""
    side, shapes = int(rng.integers(4, 9)), []
    for i in range(SIZE // side):
        for j in range(SIZE // side):
            if (i + j) % 2 == 0 and rng.random() < 0.6:
                x, y = i * side, j * side
                if rng.random() < 0.6:
                    shapes.append(shapely.box(x, y, x + side, y + side))
                else:
                    third = (x + int(rng.integers(0, side + 1)), y + side)
                    shapes.append(shapely.Polygon([(x, y), (x + side, y), third]))
    return shapes or terrace(rng)


def pieces(rng):
    """A concave polygon cut into triangles that are obstacles of their own, some left out."""
    whole = (star, letter, comb, rooms)[rng.integers(4)](rng)
    triangles = [t for one in whole for t in shapely.get_parts(shapely.constrained_delaunay_triangles(one))]
    kept = [one for one in triangles if rng.random() < 0.97]
    return kept or triangles


def slices(rng):
    """Thick letters cut along lattice lines into rectangles, with other cuts in every row."""
    parts = []
    for one in (comb, letter, spiral)[rng.integers(3)](rng):
        rest = [one]
        for _ in range(rng.integers(2, 7)):
            chosen = rest.pop(rng.integers(len(rest)))
            x0, y0, x1, y1 = chosen.bounds
            if rng.random() < 0.5:
                cut = float(rng.integers(int(x0), int(x1) + 1))
                halves = shapely.box(x0, y0, cut, y1), shapely.box(cut, y0, x1, y1)
            else:
                cut = float(rng.integers(int(y0), int(y1) + 1))
                halves = shapely.box(x0, y0, x1, cut), shapely.box(x0, cut, x1, y1)
            for half in halves:
                rest += [p for p in shapely.get_parts(chosen.intersection(half)) if p.geom_type == "Polygon"]
        parts += [piece.simplify(0.0) for piece in rest if piece.area > 0.0]
    return parts


def walls(rng):
    """Thin walls that cross, meet in corners and end at one another."""
    shapes = []
    for _ in range(rng.integers(3, 10)):
        x, y = 6 * rng.integers(0, SIZE // 6, 2)
        length = 6 * rng.integers(1, 6) + 1
        shapes.append(
            shapely.box(x, y, x + length, y + 1)
            if rng.random() < 0.5
            else shapely.box(x, y, x + 1, y + length)
        )
    return shapes


def mixed(rng):
    """Several of the other kinds, partly over one another."""
    shapes = []
    for _ in range(2):
        kind = (star, letter, terrace, corners, pieces, walls)[rng.integers(6)]
        shift = rng.integers(0, SIZE // 2, 2).astype(float)
        shapes += [shapely.transform(one, lambda points, by=shift: points + by) for one in kind(rng)]
    return shapes


def random_discs(rng):
    """Draw centres and radii of discs; some touch another one or a lattice line exactly."""
    drawn = [(*rng.integers(0, SIZE, 2), rng.integers(2, 8)) for _ in range(rng.integers(1, 6))]
    if rng.random() < 0.5:
        x, y, radius = drawn[0]
        other = rng.integers(2, 8)
        step = [(1.0, 0.0), (0.0, 1.0)][rng.integers(2)]
        drawn.append((x + step[0] * (radius + other), y + step[1] * (radius + other), other))
    return np.array(drawn, dtype=float)


# Kinds of scenes, and whether a corner may lie on the side of another obstacle by itself. Rounded coordinates
# would open or close that point.
KINDS = {
    "star": (star, False),
    "comb": (comb, False),
    "spiral": (spiral, False),
    "letter": (letter, False),
    "terrace": (terrace, False),
    "staggered": (staggered, False),
    "overlaps": (overlaps, True),
    "rooms": (rooms, False),
    "corners": (corners, True),
    "pieces": (pieces, False),
    "slices": (slices, False),
    "walls": (walls, False),
    "mixed": (mixed, True),
}


def _has_straight_corner(polygon):
    points = np.array(polygon.exterior.coords)[:-1]
    before, after = points - np.roll(points, 1, axis=0), np.roll(points, -1, axis=0) - points
    return bool((before[:, 0] * after[:, 1] == before[:, 1] * after[:, 0]).any())

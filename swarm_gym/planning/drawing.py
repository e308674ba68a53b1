"""Pictures of a path on its map, as SVG or PNG."""

import io
from collections.abc import Iterator
from typing import NamedTuple
from xml.sax.saxutils import escape

import numpy as np
from numpy.typing import NDArray

from swarm_gym.errors import MissingExtraError
from swarm_gym.planning.result import Plan
from swarm_gym.scenarios import Circle, GridScenario

Floats = NDArray[np.float64]

WIDTH, HEIGHT = 900.0, 3600.0  # most pixels of a picture, which has one of the two
LINE, DOT = 2.5, 6.0  # width of the path, radius of start and goal, in pixels
PAPER, OBSTACLE, PATH, START, GOAL = "#ffffff", "#9aa3ad", "#c2410c", "#15803d", "#1d4ed8"
EDGE = 1.0  # width of the edges of obstacles, in pixels: no seams between pieces, and lines can be seen
FINER = 3  # a PNG is drawn so many times larger and then reduced, so that edges are smooth


class _Shapes(NamedTuple):
    """The shapes of a picture, in pixels, y downwards.

    Attributes:
        width: width of the picture.
        height: height of the picture.
        circles: obstacles, (x, y, radius).
        polygons: obstacles, each with corners (k, 2).
        path: points (n, 2).
        edge: width of the edges of obstacles; 0.0 for cells.
    """

    width: float
    height: float
    circles: list[tuple[float, float, float]]
    polygons: list[Floats]
    path: Floats
    edge: float


def as_svg(plan: Plan) -> str:
    """Return a picture of the map, its obstacles and the path, as SVG."""
    shapes = _shapes_of(plan)

    def points(line: Floats) -> str:
        return " ".join(f"{x:.2f},{y:.2f}" for x, y in line.tolist())

    # Edges of cells are sharp, since smooth ones would leave seams between them.
    edges = (
        f'stroke="{OBSTACLE}" stroke-width="{shapes.edge:g}" stroke-linejoin="round"'
        if shapes.edge
        else 'shape-rendering="crispEdges"'
    )
    return "\n".join(
        [
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {shapes.width:g} {shapes.height:g}" '
            f'width="{shapes.width:g}">',
            f"<title>a path of length {plan.length:g} on {escape(plan.map.name)}</title>",
            f'<rect width="{shapes.width:g}" height="{shapes.height:g}" fill="{PAPER}"/>',
            f'<g fill="{OBSTACLE}" {edges}>',
            *(f'<circle cx="{x:.2f}" cy="{y:.2f}" r="{radius:.2f}"/>' for x, y, radius in shapes.circles),
            *(f'<polygon points="{points(corners)}"/>' for corners in shapes.polygons),
            "</g>",
            f'<polyline points="{points(shapes.path)}" fill="none" stroke="{PATH}" stroke-width="{LINE:g}"/>',
            *(
                f'<circle cx="{x:.2f}" cy="{y:.2f}" r="{DOT:g}" fill="{colour}"/>'
                for (x, y), colour in _ends(shapes)
            ),
            "</svg>",
            "",
        ]
    )


def as_png(plan: Plan) -> bytes:
    """Return the same picture as PNG.

    Raises:
        MissingExtraError: if Pillow is missing.
    """
    try:
        from PIL import Image, ImageDraw
    except ImportError as error:
        raise MissingExtraError("a picture as PNG", "Pillow", "maps") from error
    shapes = _shapes_of(plan)
    size = max(round(shapes.width), 1), max(round(shapes.height), 1)
    image = Image.new("RGB", (FINER * size[0], FINER * size[1]), PAPER)
    canvas = ImageDraw.Draw(image)

    def scaled(line: Floats) -> list[tuple[float, float]]:
        return [(FINER * x, FINER * y) for x, y in line.tolist()]

    for x, y, radius in shapes.circles:
        canvas.circle((FINER * x, FINER * y), FINER * (radius + shapes.edge / 2.0), fill=OBSTACLE)
    for corners in shapes.polygons:
        canvas.polygon(scaled(corners), fill=OBSTACLE)
        if shapes.edge:
            around = np.vstack([corners, corners[:1]])
            canvas.line(scaled(around), fill=OBSTACLE, width=round(FINER * shapes.edge), joint="curve")
    canvas.line(scaled(shapes.path), fill=PATH, width=round(FINER * LINE), joint="curve")
    for (x, y), colour in _ends(shapes):
        canvas.circle((FINER * x, FINER * y), FINER * DOT, fill=colour)
    content = io.BytesIO()
    image.resize(size, Image.Resampling.BOX).save(content, "PNG", optimize=True)
    return content.getvalue()


def _shapes_of(plan: Plan) -> _Shapes:
    scenario = plan.map
    x_min, y_min, x_max, y_max = scenario.view
    scale = min(WIDTH / (x_max - x_min), HEIGHT / (y_max - y_min))

    def in_pixels(points: Floats) -> Floats:
        x, y = np.asarray(points, dtype=np.float64).T
        return scale * np.stack([x - x_min, (y_max - y) if scenario.y_up else (y - y_min)], axis=-1)

    circles, polygons = [], []
    if isinstance(scenario, GridScenario):
        for row, first, end in _runs(scenario.map.blocked):
            cells = [(first, row), (end, row), (end, row + 1), (first, row + 1)]
            polygons.append(in_pixels(scenario.map.to_map(np.array(cells) - 0.5)))
    else:
        for obstacle in scenario.obstacles:
            if isinstance(obstacle, Circle):
                ((x, y),) = in_pixels(np.array([(obstacle.x, obstacle.y)])).tolist()
                circles.append((x, y, scale * obstacle.radius))
            else:
                polygons.append(in_pixels(np.array(obstacle.vertices)))
    edge = 0.0 if isinstance(scenario, GridScenario) else EDGE
    width, height = scale * (x_max - x_min), scale * (y_max - y_min)
    return _Shapes(width, height, circles, polygons, in_pixels(plan.path_on_map), edge)


def _ends(shapes: _Shapes) -> list[tuple[tuple[float, float], str]]:
    """Return start and goal with their colours."""
    (x, y), (goal_x, goal_y) = shapes.path[[0, -1]].tolist()
    return [((x, y), START), ((goal_x, goal_y), GOAL)]


def _runs(blocked: NDArray[np.bool_]) -> Iterator[tuple[int, int, int]]:
    """Yield row, first column and the column behind the last of every run of blocked cells."""
    edges = np.diff(np.pad(blocked.astype(np.int8), ((0, 0), (1, 1))), axis=1)
    for row in range(len(blocked)):
        firsts, ends = np.flatnonzero(edges[row] == 1), np.flatnonzero(edges[row] == -1)
        for first, end in zip(firsts.tolist(), ends.tolist(), strict=True):
            yield row, first, end

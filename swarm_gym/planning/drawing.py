"""Pictures of a path on its map, as SVG."""

from collections.abc import Iterator

import numpy as np

from swarm_gym.planning.planner import Plan
from swarm_gym.scenarios import Circle, GridScenario

WIDTH = 900.0  # of a picture, in pixels
PAPER, OBSTACLE, PATH, START, GOAL = "#ffffff", "#9aa3ad", "#c2410c", "#15803d", "#1d4ed8"


def drawing(plan: Plan) -> str:
    """Return a picture of the map, its obstacles and the path, as SVG."""
    scenario = plan.map
    x_min, y_min, x_max, y_max = scenario.view
    scale = WIDTH / (x_max - x_min)
    height = scale * (y_max - y_min)

    def at(x: float, y: float) -> tuple[float, float]:
        return scale * (x - x_min), scale * ((y_max - y) if scenario.y_up else (y - y_min))

    def points(line: np.ndarray) -> str:
        return " ".join("{:.2f},{:.2f}".format(*at(x, y)) for x, y in line.tolist())

    lines = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH:g} {height:g}" width="{WIDTH:g}">',
        f"<title>a path of length {plan.length:g} on {scenario.name}</title>",
        f'<rect width="{WIDTH:g}" height="{height:g}" fill="{PAPER}"/>',
        f'<g fill="{OBSTACLE}">',
    ]
    if isinstance(scenario, GridScenario):
        grid = scenario.map
        for row, first, end in _runs(grid.blocked):
            corners = grid.to_map([(first - 0.5, row - 0.5), (end - 0.5, row + 0.5)])
            (x, y), (far_x, far_y) = (at(*corner) for corner in corners.tolist())
            lines.append(f'<rect x="{x:.2f}" y="{y:.2f}" width="{far_x - x:.2f}" height="{far_y - y:.2f}"/>')
    else:
        for obstacle in scenario.obstacles:
            if isinstance(obstacle, Circle):
                x, y = at(obstacle.x, obstacle.y)
                lines.append(f'<circle cx="{x:.2f}" cy="{y:.2f}" r="{scale * obstacle.radius:.2f}"/>')
            else:
                lines.append(f'<polygon points="{points(np.array(obstacle.vertices))}"/>')
    lines.append("</g>")
    lines.append(f'<polyline points="{points(plan.path)}" fill="none" stroke="{PATH}" stroke-width="2.5"/>')
    for point, colour in ((plan.path[0], START), (plan.path[-1], GOAL)):
        x, y = at(*point.tolist())
        lines.append(f'<circle cx="{x:.2f}" cy="{y:.2f}" r="6" fill="{colour}"/>')
    return "\n".join([*lines, "</svg>", ""])


def _runs(blocked: np.ndarray) -> Iterator[tuple[int, int, int]]:
    """Yield row, first column and the column behind the last of every run of blocked cells."""
    edges = np.diff(np.pad(blocked.astype(np.int8), ((0, 0), (1, 1))), axis=1)
    for row in range(len(blocked)):
        firsts, ends = np.flatnonzero(edges[row] == 1), np.flatnonzero(edges[row] == -1)
        for first, end in zip(firsts.tolist(), ends.tolist(), strict=True):
            yield row, first, end

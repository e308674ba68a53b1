"""Pictures of a running swarm with pygame, which is imported only for the first of them."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from gymnasium.error import DependencyNotInstalled
from numpy.typing import NDArray

from swarm_gym.problem.cost import FEASIBILITY_TOLERANCE
from swarm_gym.scenarios import AnyScenario, Circle, Obstacle, Point, Scenario
from swarm_gym.simulation import HISTORY, Simulation

if TYPE_CHECKING:
    import pygame

Floats = NDArray[np.float64]
Colour = tuple[int, int, int]

# The hues are Okabe and Ito's, which colour-blind readers can tell apart too.
FEASIBLE: Colour = (0, 114, 178)
COLLIDING: Colour = (230, 120, 0)
START: Colour = (0, 158, 115)
TARGET: Colour = (204, 80, 150)
BEST: Colour = (17, 17, 17)
INK: Colour = (40, 44, 52)
FAINT_INK: Colour = (110, 116, 126)
OBSTACLE: Colour = (192, 197, 206)
SHADE: Colour = (226, 229, 234)
MAP: Colour = (249, 249, 246)
PAPER: Colour = (255, 255, 255)

# Pygame smooths no thick lines, so that everything is drawn larger than it is shown.
OVERSAMPLING = 2
# Lengths in this file are meant for a picture of this size, in pixels, and scale with it.
DESIGN, SMALLEST_SCALE = (960, 520), 0.8
MARGIN, HEADER, FOOTER, CHART_COLUMN = 44, 54, 62, 276
SIZES = SMALL, MEDIUM, LARGE = 17, 20, 26
# Of a path; a curve that is sampled more densely looks the same.
MOST_SEGMENTS = 100
# Of a scenario, in letters; there is no room for more.
LONGEST_NAME = 20


@dataclass(frozen=True, eq=False)
class Scene:
    """What one picture shows of one swarm; lengths in map units, paths in map coordinates."""

    scenario: AnyScenario
    paths: Floats  # (members, k, 2)
    feasible: NDArray[np.bool_]  # (members,) which paths do not collide
    best_path: Floats  # (k, 2) best so far
    best_fitness: float  # infinite before the first evaluation
    best_feasible: bool
    iteration: int
    iterations: int
    evaluations: int
    max_population_size: int
    courses: dict[str, Floats]  # (iteration + 1,) each, the columns of the history

    @classmethod
    def of(cls, simulation: Simulation, row: int = 0) -> "Scene":
        """Copy the present state of one swarm."""
        swarms, problem = simulation.swarms, simulation.problem_of(row)
        iteration = int(simulation.iteration[row])
        return cls(
            scenario=problem.scenario,
            paths=_thinned(problem.points(simulation.positions(row))),
            feasible=swarms.collision[row, : swarms.size[row]] <= FEASIBILITY_TOLERANCE,
            best_path=_thinned(problem.points(simulation.best_position(row))),
            best_fitness=float(swarms.best_fitness[row]),
            best_feasible=bool(swarms.best_collision[row] <= FEASIBILITY_TOLERANCE),
            iteration=iteration,
            iterations=simulation.settings.iterations,
            evaluations=int(swarms.evaluations[row]),
            max_population_size=simulation.settings.max_population_size,
            courses=dict(
                zip(simulation.columns, simulation.history[row, : iteration + 1].T.copy(), strict=True)
            ),
        )


def _thinned(paths: Floats) -> Floats:
    """Paths (..., k, 2) with fewer points, the first and the last of them kept, where there are very many."""
    stride = max(1, (paths.shape[-2] - 1) // MOST_SEGMENTS)
    return np.concatenate([paths[..., :-1:stride, :], paths[..., -1:, :]], axis=-2)


class Renderer:
    """Draws scenes, as arrays or into a window, where it shows at most `fps` pictures per second.

    Raises:
        DependencyNotInstalled: by the first picture, if pygame is missing.
    """

    def __init__(self, width: int = DESIGN[0], height: int = DESIGN[1], fps: int = 20):
        self.size = (width, height)
        self.fps = fps
        self._map: MapView | None = None
        self._clock: pygame.time.Clock | None = None
        self._dismissed = False

    def frame(self, scene: Scene) -> NDArray[np.uint8]:
        """Draw a picture, shape (height, width, 3); needs no display."""
        pixels = _require_pygame().surfarray.array3d(self._draw(scene))
        return np.ascontiguousarray(pixels.swapaxes(0, 1))

    def show(self, scene: Scene) -> None:
        """Put a picture into the window; does nothing once the user has closed it."""
        if self._dismissed:
            return
        pygame = _require_pygame()
        window = pygame.display.get_surface()
        # Pygame has one window per process, so that another renderer may have closed or resized it.
        if window is None or window.get_size() != self.size:
            window = pygame.display.set_mode(self.size)
            pygame.display.set_caption("swarm_gym")
        self._clock = self._clock or pygame.time.Clock()
        if any(event.type == pygame.QUIT for event in pygame.event.get()):
            self.close()
            self._dismissed = True
            return
        window.blit(self._draw(scene), (0, 0))
        pygame.display.flip()
        self._clock.tick(self.fps)

    def close(self) -> None:
        """Close the window, if this renderer has shown anything."""
        if self._clock is not None:
            _require_pygame().display.quit()
            self._clock = None

    def _draw(self, scene: Scene) -> "pygame.Surface":
        pygame = _require_pygame()
        if self._map is None or self._map.scenario != scene.scenario:
            canvas = pygame.Surface(OVERSAMPLING * np.array(self.size))
            self._map = MapView(scene.scenario, Pen(canvas))
        pen = Pen(self._map.background.copy())
        self._map.draw_swarm(pen, scene)
        _draw_headline(pen, scene)
        _draw_legend(pen, scene, pen.px(MARGIN), self._map.border.bottom + pen.px(38))
        _draw_charts(pen, scene)
        return pygame.transform.smoothscale(pen.surface, self.size)


class Pen:
    """Draws on an oversampled surface, whose pixels `px` counts."""

    def __init__(self, surface: "pygame.Surface"):
        self.surface = surface
        self.width, self.height = surface.get_size()
        fits = self.width / DESIGN[0], self.height / DESIGN[1]
        self.scale = max(min(fits), SMALLEST_SCALE * OVERSAMPLING)
        pygame = self.pygame = _require_pygame()
        self.draw = pygame.draw
        # Made anew, because fonts do not outlive a `pygame.quit` of somebody else.
        pygame.font.init()
        self._fonts = {size: pygame.font.Font(None, self.px(size)) for size in SIZES}

    def px(self, length: float) -> int:
        """Convert a length of the design to pixels of the surface, at least one."""
        return max(1, round(length * self.scale))

    def lines(self, colour: Colour, lines: Floats, width: float) -> None:
        """Draw lines (m, k, 2), with round joints where they are thick."""
        thickness = self.px(width)
        for line in lines:
            self.draw.lines(self.surface, colour, False, line, thickness)
            for point in line[1:-1] if thickness > 3 else ():
                self.draw.circle(self.surface, colour, point, thickness / 2)

    def dashes(self, colour: Colour, lines: Floats, width: float) -> None:
        """Draw lines (m, k, 2) dashed, with one to three dashes per segment."""
        steps = np.diff(lines, axis=1).reshape(-1, 2)
        counts = np.clip(np.hypot(*steps.T) // self.px(14), 1, 3).astype(np.int64)
        segment = np.repeat(np.arange(len(steps)), counts)
        number = np.arange(len(segment)) - (np.cumsum(counts) - counts)[segment]
        dash = (steps / counts[:, None])[segment]
        # Where a line begins its dashes differs between lines, lest neighbours leave common gaps.
        shift = 0.4 * (0.618 * (segment // (lines.shape[1] - 1)) % 1.0)
        begins = lines[:, :-1].reshape(-1, 2)[segment] + (number + shift)[:, None] * dash
        ends, thickness = begins + 0.6 * dash, self.px(width)
        for x0, y0, x1, y1 in zip(*begins.T.tolist(), *ends.T.tolist(), strict=True):
            self.draw.line(self.surface, colour, (x0, y0), (x1, y1), thickness)

    def text(self, text: str, at: Point, anchor: str, size: int = SMALL) -> "pygame.Rect":
        """Write text, small text faintly, at the point that pygame's rectangles call `anchor`."""
        image = self._fonts[size].render(text, True, FAINT_INK if size == SMALL else INK)
        return self.surface.blit(image, image.get_rect(**{anchor: at}))


class MapView:
    """The map of a scenario: its picture without a swarm, and where points are on it."""

    def __init__(self, scenario: AnyScenario, pen: Pen):
        self.scenario = scenario
        self.background = pen.surface
        low, high = np.reshape(scenario.view, (2, 2))
        corner = np.array([pen.px(MARGIN), pen.px(HEADER)])
        room = [pen.width - pen.px(CHART_COLUMN), pen.height - pen.px(FOOTER)] - corner
        self._scale = (room / (high - low)).min()
        size = np.maximum(1.0, self._scale * (high - low))
        self._origin = corner + (room + size * [-1, 1]) / 2
        self.border = border = pen.pygame.Rect(self._origin - size * [0, 1], size)
        pen.surface.fill(PAPER)
        pen.draw.rect(pen.surface, MAP, border)
        pen.surface.set_clip(border)
        if isinstance(scenario, Scenario):
            for obstacle in scenario.obstacles:
                self._draw_obstacle(pen, obstacle)
        else:
            self._draw_cells(pen, scenario.map.blocked[scenario.window])
        pen.surface.set_clip(None)
        pen.draw.rect(pen.surface, FAINT_INK, border.inflate(pen.px(2), pen.px(2)), pen.px(1))
        below, before = border.bottom + pen.px(5), border.left - pen.px(6)
        pen.text(f"{low[0]:g}", (border.left, below), "topleft")
        pen.text(f"{high[0]:g}", (border.right, below), "topright")
        bottom, top = (low[1], high[1]) if scenario.y_up else (high[1], low[1])
        pen.text(f"{bottom:g}", (before, border.bottom), "bottomright")
        pen.text(f"{top:g}", (before, border.top), "topright")

    def pixels(self, points: Floats) -> Floats:
        """Convert map coordinates (..., 2) to the picture's, whose y grows downward."""
        x_min, y_min, _, y_max = self.scenario.view
        if self.scenario.y_up:
            return self._origin + (points - (x_min, y_min)) * [self._scale, -self._scale]
        return self._origin + (points - (x_min, y_max)) * self._scale

    def draw_swarm(self, pen: Pen, scene: Scene) -> None:
        """Draw the colliding members, above them the feasible ones, and the best path on top."""
        pen.surface.set_clip(self.border)
        paths = self.pixels(scene.paths)
        pen.dashes(COLLIDING, paths[~scene.feasible], 1)
        pen.lines(FEASIBLE, paths[scene.feasible], 1)
        if np.isfinite(scene.best_fitness):
            pen.lines(BEST, self.pixels(scene.best_path[None]), 2.8)
        pen.surface.set_clip(None)
        self._draw_end(pen, "start", self.scenario.start, START, corners=48)
        self._draw_end(pen, "target", self.scenario.target, TARGET, corners=4)

    def _draw_obstacle(self, pen: Pen, obstacle: Obstacle) -> None:
        if isinstance(obstacle, Circle):
            centre = self.pixels(np.array([obstacle.x, obstacle.y]))
            pen.draw.circle(pen.surface, OBSTACLE, centre, obstacle.radius * self._scale)
        else:
            pen.draw.polygon(pen.surface, OBSTACLE, self.pixels(np.array(obstacle.vertices)))

    def _draw_cells(self, pen: Pen, blocked: NDArray[np.bool_]) -> None:
        """Draw a grid map, row 0 on top, over the whole border."""
        pixels = np.where(blocked.T[..., None], OBSTACLE, MAP).astype(np.uint8)
        cells = pen.pygame.surfarray.make_surface(pixels)
        pen.surface.blit(pen.pygame.transform.scale(cells, self.border.size), self.border)

    def _draw_end(self, pen: Pen, name: str, point: Point, colour: Colour, corners: int) -> None:
        angles = 2 * np.pi * np.arange(corners) / corners
        shape = np.stack([np.cos(angles), np.sin(angles)], axis=1)
        at = self.pixels(np.array(point))
        pen.draw.polygon(pen.surface, PAPER, at + pen.px(10) * shape)
        pen.draw.polygon(pen.surface, colour, at + pen.px(7.5) * shape)
        side = 1 if at[1] + pen.px(40) < self.border.bottom else -1
        box = pen.pygame.Rect(0, 0, pen.px(52), pen.px(19))
        box.center = (at[0], at[1] + side * pen.px(23))
        box.clamp_ip(self.border.inflate(-pen.px(6), -pen.px(6)))
        pen.draw.rect(pen.surface, PAPER, box, border_radius=pen.px(4))
        pen.draw.rect(pen.surface, colour, box, pen.px(1), border_radius=pen.px(4))
        pen.text(name, box.center, "center", MEDIUM)


def _draw_headline(pen: Pen, scene: Scene) -> None:
    facts = (
        f"iteration {scene.iteration} of {scene.iterations}     "
        f"best fitness {scene.best_fitness:.5g}     evaluations {scene.evaluations:,}"
    )
    name = scene.scenario.name
    if len(name) > LONGEST_NAME:
        name = f"{name[: LONGEST_NAME - 1]}…"
    box = pen.text(name, (pen.px(MARGIN), pen.px(28)), "midleft", LARGE)
    pen.text(facts, (box.right + pen.px(24), pen.px(28)), "midleft", MEDIUM)


def _draw_legend(pen: Pen, scene: Scene, x: int, y: int) -> None:
    for draw, colour, width, text in (
        (pen.lines, BEST, 2.8, f"best so far{'' if scene.best_feasible else ' (collides)'}"),
        (pen.lines, FEASIBLE, 1, f"{scene.feasible.sum()} feasible"),
        (pen.dashes, COLLIDING, 1, f"{(~scene.feasible).sum()} colliding"),
    ):
        draw(colour, np.array([[(x, y), (x + pen.px(44), y)]]), width)
        x = pen.text(text, (x + pen.px(52), y), "midleft", MEDIUM).right + pen.px(24)


def _draw_charts(pen: Pen, scene: Scene) -> None:
    collision, size, repair = (scene.courses[name] for name in HISTORY[:3])
    charts = (
        ("collision E(P)", ".4g", collision, collision.max() or 1.0),
        ("population size", ".0f", size, scene.max_population_size),
        ("repair degree φ", ".2f", repair, 1.0),
    )
    height = (pen.height - pen.px(20)) // len(charts)
    area = pen.pygame.Rect(pen.width - pen.px(224), pen.px(18), pen.px(204), height)
    for title, form, values, top in charts:
        pen.text(title, area.topleft, "topleft", MEDIUM)
        pen.text(f"{values[-1]:{form}}", area.topright, "topright", LARGE)
        plot = pen.pygame.Rect(area.x, area.y + pen.px(23), area.width, area.height - pen.px(53))
        _draw_course(pen, plot, values / top, scene.iterations)
        pen.text(f"{top:{form}}", (plot.left - pen.px(6), plot.top), "topright")
        area.top += area.height


def _draw_course(pen: Pen, plot: "pygame.Rect", shares: Floats, iterations: int) -> None:
    x = plot.left + np.arange(len(shares)) / iterations * plot.width
    course = np.stack([x, plot.bottom - shares * plot.height], axis=1)
    course = np.vstack([course[:1], course])  # a line even before the first iteration
    pen.draw.rect(pen.surface, MAP, plot)
    pen.draw.polygon(pen.surface, SHADE, [*course, (x[-1], plot.bottom), plot.bottomleft])
    pen.lines(FAINT_INK, np.array([[plot.topleft, plot.bottomleft, plot.bottomright]]), 1)
    pen.lines(INK, course[None], 1.5)
    pen.draw.circle(pen.surface, INK, course[-1], pen.px(3.5))
    pen.text("iteration", (plot.centerx, plot.bottom + pen.px(5)), "midtop")
    pen.text("0", (plot.left - pen.px(6), plot.bottom), "bottomright")
    pen.text(f"{iterations}", (plot.right, plot.bottom + pen.px(5)), "topright")


def _require_pygame() -> Any:
    try:
        import pygame
    except ImportError as error:
        raise DependencyNotInstalled('pygame: run `pip install "swarm_gym[render]"`') from error
    return pygame

"""Pictures show the state of the swarm, the same every time, with and without a window."""

import sys
from dataclasses import replace

import gymnasium
import numpy as np
import pytest
from gymnasium.error import DependencyNotInstalled
from gymnasium.utils.env_checker import check_env

import swarm_gym  # noqa: F401
from swarm_gym.errors import SettingError
from swarm_gym.history import HISTORY
from swarm_gym.problem import FunctionProblem
from swarm_gym.rendering import Renderer, Scene, pen
from swarm_gym.scenarios import Circle, Polygon, Scenario, make_scenario

pygame = pytest.importorskip("pygame")

ACTION = np.array([12.0, 0.3])
OPTIONS = {"num_waypoints": 9, "iterations": 6, "initial_population_size": 12}


def make_env(render_mode="rgb_array", **options):
    return gymnasium.make("swarm_gym/Firefly-v0", render_mode=render_mode, **{**OPTIONS, **options})


def scene_after(steps, **options):
    env = make_env(**options)
    env.reset(seed=1)
    for _ in range(steps):
        env.step(ACTION)
    return Scene.of(env.unwrapped.simulation)


def straight(scenario, offset=0.0):
    """Return a path of three points beside the line from start to target."""
    start, target = np.array(scenario.start), np.array(scenario.target)
    return np.array([start, (start + target) / 2 + [0.0, offset], target])


def empty_scene(scenario, **changes):
    """Return a scene without members and without a best path."""
    scene = Scene(
        scenario=scenario,
        paths=np.empty((0, 3, 2)),
        are_points=False,
        feasible=np.empty(0, dtype=np.bool_),
        best_path=np.zeros((3, 2)),
        trajectory=np.empty((0, 2)),
        best_fitness=np.inf,
        best_feasible=False,
        iteration=0,
        iterations=10,
        evaluations=0,
        max_population_size=20,
        courses={name: np.zeros(1) for name in HISTORY},
    )
    return replace(scene, **changes)


OPEN_MAP = Scenario("open", (100.0, 300.0), (900.0, 300.0), (), (0.0, 0.0, 1000.0, 600.0))


def places(frame, colour, tolerance=40):
    """Return (k, 2) row and column of the pixels that nearly have this colour."""
    return np.argwhere(np.abs(frame.astype(int) - colour).max(axis=-1) < tolerance)


def changed(before, after):
    """Return (k, 2) row and column of the pixels in which two pictures differ."""
    return np.argwhere((before != after).any(axis=-1))


@pytest.mark.parametrize("size", [(960, 520), (640, 400), (400, 500), (333, 241)])
def test_frames_have_the_size_that_renderer_and_environment_were_made_with(size):
    env = make_env(render_width=size[0], render_height=size[1])
    env.reset(seed=1)
    frame = env.render()
    assert frame.shape == (size[1], size[0], 3)
    assert frame.dtype == np.uint8
    assert frame.flags.c_contiguous
    assert frame.flags.writeable
    assert frame.std() > 0
    np.testing.assert_array_equal(frame, Renderer(*size).frame(Scene.of(env.unwrapped.simulation)))


def test_the_size_of_frames_changes_no_result():
    assert make_env(render_width=640).unwrapped.settings == make_env().unwrapped.settings


@pytest.mark.parametrize(
    ("option", "value", "message"),
    [
        ("render_width", 319, r"render_width must lie in \[320, 4096\], got 319"),
        ("render_height", 4097, r"render_height must lie in \[240, 4096\], got 4097"),
        ("render_height", 400.0, r"render_height must be an integer, got 400.0"),
    ],
)
def test_sizes_that_frames_cannot_have_are_refused(option, value, message):
    with pytest.raises(SettingError, match=message):
        make_env(**{option: value})


def test_a_picture_does_not_depend_on_those_before_it():
    scenes = [scene_after(2), scene_after(0, scenario="case2"), scene_after(3, scenario="case2")]
    for size in ((640, 400), (960, 520)):
        renderer = Renderer(*size)
        for scene in (*scenes, *scenes):
            np.testing.assert_array_equal(renderer.frame(scene), Renderer(*size).frame(scene))


def test_drawing_shows_that_the_swarm_moves_and_leaves_the_simulation_alone():
    env, twin = make_env(), make_env()
    for each in (env, twin):
        each.reset(seed=1)
    for _ in range(3):
        before = env.render()
        env.step(ACTION)
        twin.step(ACTION)
        assert (before != env.render()).any()
    for mine, other in zip(env.unwrapped.simulation.swarms, twin.unwrapped.simulation.swarms, strict=True):
        np.testing.assert_array_equal(mine, other)


def test_a_scene_does_not_change_when_the_swarm_moves_on():
    env = make_env()
    env.reset(seed=1)
    scene = Scene.of(env.unwrapped.simulation)
    before = Renderer().frame(scene)
    for _ in range(3):
        env.step(ACTION)
    env.reset(seed=2)
    np.testing.assert_array_equal(Renderer().frame(scene), before)


def test_a_scene_tells_the_state_of_its_swarm():
    env = make_env()
    env.reset(seed=1)
    env.step(np.array([7.0, 0.25]))
    *_, info = env.step(np.array([5.0, 0.75]))
    scene = Scene.of(env.unwrapped.simulation)
    assert scene.paths.shape == (5, OPTIONS["num_waypoints"] + 2, 2)
    assert scene.feasible.mean() == info["feasible_share"]
    assert scene.best_fitness == info["best_fitness"]
    np.testing.assert_array_equal(scene.best_path, info["best_path"])
    assert (scene.iteration, scene.iterations) == (2, 6)
    assert scene.evaluations == info["evaluations"]
    np.testing.assert_array_equal(scene.courses["population_size"], [12, 7, 5])
    np.testing.assert_array_equal(scene.courses["repair_degree"], [0.0, 0.25, 0.75])


def test_feasible_members_are_solid_and_colliding_ones_dashed_in_their_colours():
    empty = empty_scene(OPEN_MAP)
    covered = {}
    for feasible in (True, False):
        member = replace(empty, paths=straight(OPEN_MAP, 80.0)[None], feasible=np.array([feasible]))
        before, after = (Renderer().frame(scene) for scene in (empty, member))
        colour, other = (pen.FEASIBLE, pen.COLLIDING)[:: 1 if feasible else -1]
        assert len(places(after, colour)) > len(places(before, colour))
        assert len(places(after, other)) == len(places(before, other))
        rows, columns = changed(before, after).T
        inside = (columns > 150) & (columns < 580) & (rows > 80) & (rows < 400)
        covered[feasible] = set(columns[inside])
    assert len(covered[True]) == 580 - 151
    assert 0.3 < len(covered[False]) / len(covered[True]) < 0.8


@pytest.mark.parametrize("width", [0.5, 1, 2, 3])
def test_dashes_are_where_pygame_would_draw_them(width):
    rng = np.random.default_rng(0)
    lines = rng.uniform(50, 350, (40, 2, 2))
    lines[:20, :, 0], lines[20:, :, 1] = 0.2 * lines[:20, :, 0], 0.2 * lines[20:, :, 1]
    lines[1, 1, 0], lines[21, 1, 1] = lines[1, 0, 0], lines[21, 0, 1]
    for line in lines:
        ours, theirs = (pen.Pen(pygame.Surface((400, 400))) for _ in range(2))
        ours.dashes((255, 0, 0), line[None], width)
        # One to three dashes, each six tenths of its part; the first one begins at the start of the line.
        count = int(np.clip(np.hypot(*(line[1] - line[0])) // ours.px(14), 1, 3))
        for k in range(count):
            begin, end = (line[0] + (k + part) / count * (line[1] - line[0]) for part in (0, 0.6))
            theirs.draw.line(theirs.surface, (255, 0, 0), begin, end, ours.px(width))
        marked = [np.argwhere(pygame.surfarray.array_red(each.surface)) for each in (ours, theirs)]
        apart = np.abs(marked[0][:, None] - marked[1]).max(axis=-1)
        assert apart.min(axis=0).max() <= 1
        assert apart.min(axis=1).max() <= 1


def test_dashes_stay_within_what_may_be_drawn():
    each = pen.Pen(pygame.Surface((300, 200)))
    each.surface.set_clip((40, 30, 100, 80))
    each.dashes((255, 0, 0), np.random.default_rng(0).uniform(-400, 700, (300, 4, 2)), 2)
    columns, rows = np.nonzero(pygame.surfarray.array_red(each.surface))
    assert (columns.min(), rows.min()) >= (40, 30)
    assert columns.max() < 140
    assert rows.max() < 110
    assert len(columns) > 0.7 * 100 * 80
    for nothing in (np.empty((0, 3, 2)), np.full((2, 3, 2), -9.0)):
        each.dashes((0, 255, 0), nothing, 1)
    assert not pygame.surfarray.array_green(each.surface).any()


def test_members_that_are_points_are_dots_and_colliding_ones_rings():
    at = np.array([500.0, 380.0])
    empty = empty_scene(OPEN_MAP, are_points=True, paths=np.empty((0, 2, 2)))
    paths = np.array([[at, OPEN_MAP.target]])
    coloured = {}
    for feasible, colour in ((True, pen.FEASIBLE), (False, pen.COLLIDING)):
        frame = Renderer().frame(replace(empty, paths=paths, feasible=np.array([feasible])))
        found = places(frame, colour)
        found = found[found[:, 0] < 400]  # not in the legend
        coloured[feasible] = len(found)
        assert 0 < np.ptp(found, axis=0).max() <= 8
    assert coloured[False] < coloured[True]


def test_the_trajectory_and_place_of_a_walking_robot_are_shown():
    env = gymnasium.make("swarm_gym/Glowworm-v0", scenario="block:50", render_mode="rgb_array")
    env.reset(seed=1)
    while not env.step(np.array([65.0, 0.0]))[2]:
        pass
    simulation = env.unwrapped.simulation
    scene = Scene.of(simulation)
    assert scene.are_points
    assert len(scene.trajectory) > 100
    np.testing.assert_array_equal(scene.trajectory[-1], simulation.positions(0)[0])
    np.testing.assert_array_equal(scene.best_path[-1], scene.scenario.target)
    length = np.linalg.norm(np.diff(scene.best_path, axis=0), axis=1).sum()
    assert length == pytest.approx(scene.best_fitness, rel=0.01)  # the scene leaves some points out
    assert len(places(env.render(), pen.BEST)) > 300


def test_the_best_path_lies_on_top_of_the_members():
    members = empty_scene(
        OPEN_MAP, paths=np.repeat(straight(OPEN_MAP, 80.0)[None], 30, axis=0), feasible=np.ones(30, bool)
    )
    best = replace(members, best_path=straight(OPEN_MAP, 80.0), best_fitness=300.0)
    before, after = (places(Renderer().frame(scene), pen.BEST) for scene in (members, best))
    assert len(after) > len(before) + 500


def test_a_best_path_that_collides_is_called_so():
    scene = scene_after(1)
    frames = [Renderer().frame(replace(scene, best_feasible=flag)) for flag in (True, False)]
    assert len(changed(*frames)) > 0


@pytest.mark.parametrize(
    "workspace", [(0.0, 0.0, 6000.0, 600.0), (-500.0, 1000.0, -300.0, 2000.0), (0.0, 0.0, 1.0, 1.0)]
)
def test_a_map_of_any_shape_keeps_its_proportions_and_its_up(workspace):
    low, high = np.reshape(workspace, (2, 2))
    start, target = (tuple(low + share * (high - low)) for share in ([0.5, 0.05], [0.5, 0.95]))
    scenario = Scenario("odd", start, target, (), workspace)
    bare = Renderer().frame(empty_scene(scenario))
    on_map, on_picture = [], []
    for share in ([0.2, 0.65], [0.8, 0.35]):
        centre = low + share * (high - low)
        obstacles = (Circle(*centre, 0.1 * (high - low).min()),)
        frame = Renderer().frame(empty_scene(replace(scenario, obstacles=obstacles)))
        rows, columns = changed(bare, frame).T
        assert np.ptp(rows) == pytest.approx(np.ptp(columns), abs=2)
        on_map.append(centre)
        on_picture.append([columns.mean(), rows.mean()])
    scale = np.diff(on_picture, axis=0)[0] / np.diff(on_map, axis=0)[0]
    assert scale[0] > 0
    assert scale[0] == pytest.approx(-scale[1], rel=0.05)


def test_obstacles_do_not_leave_the_workspace():
    outside = (Circle(1000, 100, 80), Polygon.rectangle(900, 500, 1200, 900))
    bare = Renderer().frame(empty_scene(OPEN_MAP))
    scenario = replace(OPEN_MAP, obstacles=outside)
    rows, columns = changed(bare, Renderer().frame(empty_scene(scenario))).T
    border = places(bare, pen.FAINT_INK, 5)
    right = border[border[:, 1] < 700, 1].max()
    assert columns.max() <= right
    assert rows.min() > 50


@pytest.mark.parametrize("course", HISTORY[:3])
def test_every_chart_shows_its_course(course):
    flat = {name: np.array([0.5, 1.0, 0.5]) for name in HISTORY}
    bent = {**flat, course: np.array([0.5, 0.1, 0.5])}
    scenes = [
        empty_scene(OPEN_MAP, iteration=2, max_population_size=1, courses=courses) for courses in (flat, bent)
    ]
    places_changed = changed(*(Renderer().frame(scene) for scene in scenes))
    third = HISTORY.index(course)
    assert len(places_changed) > 50
    assert set((places_changed[:, 0] - 10) // 170) == {third}
    assert places_changed[:, 1].min() > 690


@pytest.mark.parametrize("name", ["function:booth-2", "function:sum-squares-1", "function:easom-20"])
def test_members_on_a_test_function_are_dots_where_their_first_two_components_are(name):
    problem = FunctionProblem(make_scenario(name))
    low, high = problem.bounds
    bare = empty_scene(problem.scenario, paths=np.empty((0, 2, 2)))
    before = Renderer().frame(bare)[55:335, :700]

    def centre(vector, as_member):
        """Return column and row of a dot of this colour."""
        points = problem.points(vector)[:2]
        scene = replace(bare, best_path=points, best_fitness=1.0)
        if as_member:
            scene = replace(bare, paths=points[None], feasible=np.ones(1, bool))
        after = Renderer().frame(scene)[55:335, :700]  # below the swarm is the legend
        colour = pen.FEASIBLE if as_member else pen.BEST
        assert len(places(after, colour)) > len(places(before, colour))
        return changed(before, after).mean(axis=0)[::-1]

    first, second = 0.6 * high, 0.3 * low
    ways = [centre(first, as_member) - centre(second, as_member) for as_member in (True, False)]
    np.testing.assert_allclose(ways[0], ways[1], atol=1.0)
    assert ways[0][0] > 100
    assert ways[0][1] == pytest.approx(0.0 if problem.dimension == 1 else -ways[0][0], abs=1.0)
    third = np.where(np.arange(problem.dimension) < 2, first, second)
    np.testing.assert_array_equal(centre(third, True), centre(first, True))


def test_a_test_function_is_lightest_at_its_optimum_and_nowhere_as_dark_as_a_dot():
    scenario = make_scenario("function:sum-squares-2-shifted:1")
    ground = Renderer().frame(empty_scene(scenario, paths=np.empty((0, 2, 2))))[80:430, 180:540].astype(int)
    optimum = places(ground, pen.TARGET)
    row, column = optimum.mean(axis=0).round().astype(int)
    darkness = ground.min(axis=-1)
    darkness[row - 12 : row + 13, column - 12 : column + 13] = 255
    assert darkness.min() > 130
    assert darkness[[0, 0, -1, -1], [0, -1, 0, -1]].max() < darkness[row - 14, column]


def test_environments_of_test_functions_draw_themselves():
    env = gymnasium.make(
        "swarm_gym/Firefly-v0",
        scenario=["function:rastrigin-10-shifted:0-3"],
        iterations=4,
        render_mode="rgb_array",
    )
    check_env(env.unwrapped, skip_render_check=False)
    env.reset(seed=0)
    before = env.render()
    env.step(ACTION)
    assert (before != env.render()).any()


def test_the_first_frame_needs_no_step_and_no_display(monkeypatch):
    monkeypatch.setenv("SDL_VIDEODRIVER", "none such")
    pygame.display.quit()
    env = make_env()
    assert env.unwrapped.render().std() > 0  # not even a reset
    env.reset(seed=1)
    assert env.render().std() > 0
    assert not pygame.display.get_init()


def test_human_mode_shows_every_step_and_closes_twice(window):
    env = make_env("human")
    env.reset(seed=1)
    for _ in range(2):
        env.step(ACTION)
    shown = pygame.surfarray.array3d(pygame.display.get_surface()).swapaxes(0, 1)
    np.testing.assert_array_equal(shown, Renderer().frame(Scene.of(env.unwrapped.simulation)))
    assert env.render() is None
    pygame.event.post(pygame.event.Event(pygame.KEYDOWN, key=pygame.K_SPACE))
    assert env.render() is None  # and it has read the key
    assert "paused" in pygame.display.get_caption()[0]
    env.unwrapped.close()
    env.unwrapped.close()
    assert pygame.display.get_surface() is None


def test_a_renderer_closes_twice_and_opens_again_also_after_another_one_quit_pygame(window):
    renderer, scene = Renderer(fps=1000), scene_after(0)
    renderer.close()
    for _ in range(2):
        for end in (pygame.quit, renderer.close):
            renderer.show(scene)
            assert pygame.display.get_surface() is not None
            end()
        renderer.close()
        assert pygame.display.get_surface() is None


def test_a_window_that_the_user_closed_stays_closed(window):
    renderer, scene = Renderer(fps=1000), scene_after(0)
    renderer.show(scene)
    pygame.event.post(pygame.event.Event(pygame.QUIT))
    for _ in range(3):
        renderer.show(scene)
        assert pygame.display.get_surface() is None
    renderer.close()


def test_renderers_of_different_sizes_take_turns_with_the_window(window):
    scene = scene_after(0)
    for size in ((960, 520), (640, 400)):
        renderer = Renderer(*size, fps=1000)
        renderer.show(scene)
        shown = pygame.surfarray.array3d(pygame.display.get_surface()).swapaxes(0, 1)
        np.testing.assert_array_equal(shown, renderer.frame(scene))


def test_a_missing_pygame_says_what_to_install(monkeypatch):
    scene = scene_after(0)
    monkeypatch.setitem(sys.modules, "pygame", None)
    with pytest.raises(DependencyNotInstalled, match=r"pip install \"swarm_gym\[render\]\""):
        Renderer().frame(scene)

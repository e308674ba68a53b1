"""Tuning of decisions on new members: where the search starts, first populations, files, resuming."""

import dataclasses
import json

import numpy as np
import pytest

from agents import make_controller
from swarm_gym.controllers.knots import Knots
from swarm_gym.controllers.open_loop import OpenLoop, save_open_loop
from swarm_gym.env import SwarmEnv
from swarm_gym.runs.seeds import TRAINING_START
from swarm_gym.sources import SOURCE_DECISIONS, Source
from swarm_gym.tuning.config import TuneConfig
from swarm_gym.tuning.knots import BESIDE_THE_WALLS, START, KnotSpace
from swarm_gym.tuning.run import TuningRun
from swarm_gym.tuning.side_by_side import SideBySide
from swarm_gym.tuning.tuners import kind_defaults

TINY = {"episodes": 4, "scenarios": ("case3", "case1"), "max_population_size": 12}
STEPS = 4 * 4 * 100  # of a generation of four candidates
KNOTS = (0, 3, 8, 15, 40, 99)
SOURCES = {
    "smooth_share": [0.2, 0.3, 0.4, 0.5, 0.6, 0.7],
    "amplitude": [0.5, 0.4, 0.3, 0.2, 0.1, 0.05],
    "immigrants": [0.01, 0.04, 0.09, 0.16, 0.25, 0.36],
}


@pytest.fixture(autouse=True)
def short_estimate(monkeypatch):
    monkeypatch.setattr("swarm_gym.tuning.run.ESTIMATE_EPISODES", 2)


def tune(folder, rounds=2, **options):
    defaults = kind_defaults(options.pop("what", "open-loop"))
    small = {"candidates": 4, "initial_population_size": 6, "total_steps": rounds * STEPS, "name": "it"}
    given = {"action": "sourced", "runs": folder, **options}
    return TuningRun(dataclasses.replace(defaults, **{**TINY, **small, **given}))


@pytest.fixture
def sourced_file(tmp_path):
    """Return the name of an open loop with decisions on new members."""
    path = tmp_path / "sourced.json"
    knobs = {"noise": [2.0] * 6, "attractiveness": [0.1] * 6}
    sizes, degrees = [70.0, 40.0, 30.0, 20.0, 10.0, 9.0], [0.5, 0.4, 0.3, 0.2, 0.1, 0.05]
    save_open_loop(path, Knots(33, list(KNOTS), sizes, degrees, knobs, SOURCES, Source(0.5, 0.2)), {})
    return f"open-loop:{path}"


def kept_off_walls(values, low, high, scale):
    """Return the values that a search can start at; `scale` names how the decision is scaled."""
    values = np.clip(values, low, high)
    margin = BESIDE_THE_WALLS
    if scale == "logarithmic":
        ratio = high / low
        return np.clip(values, low * ratio**margin, low * ratio ** (1 - margin))
    if scale == "root":
        return np.clip(values, margin**2, (1 - margin) ** 2)
    return np.clip(values, margin, 1 - margin)


def decided_by(decided):
    """Return the decisions at all knots, (decisions, knots)."""
    more = [*decided.knobs.values(), *decided.sources.values()]
    return np.array([decided.sizes, decided.repair_degrees, *more])


# By decision: its range, and the value at which a search starts that knows nothing better.
RANGES = [
    (2.0, 200.0, "logarithmic"), (0.0, 1.0, "root"),
    (0.02, 100.0, "logarithmic"), (0.01, 1.0, "logarithmic"),
    (0.0, 1.0, "linear"), (0.01, 1.0, "logarithmic"), (0.0, 1.0, "root"),
]  # fmt: skip
DEFAULTS = [60.0, 0.0004, 2.0, 0.1, 0.98, 0.4, 0.0004]


def test_a_search_without_a_start_begins_at_what_a_search_found():
    begin = (space := KnotSpace(TuneConfig(action="sourced", initial_population_size=40))).decode(space.start)
    for name in SOURCE_DECISIONS:
        assert begin.sources[name] == pytest.approx(START["sourced"][name])
    assert begin.initial_population_size == 40
    assert (begin.first_source.smooth_share, begin.first_source.amplitude) == pytest.approx((0.8, 0.2))


@pytest.mark.parametrize(
    ("action", "start", "known"),
    [
        ("sourced", "open-loop:three-cases-extended@0.1", 4),
        ("sourced", "open-loop:three-cases", 2),
        ("extended", "open-loop:three-cases-extended@2", 4),
        ("extended", "open-loop:three-cases", 2),
        ("natural", "open-loop:three-cases-extended", 2),
    ],
)
def test_a_search_starts_at_the_decisions_of_an_open_loop(action, start, known):
    space, loop = KnotSpace(TuneConfig(action=action, start=start)), make_controller(start)
    found = decided_by(space.decode(space.start))
    rows = np.minimum(KNOTS, len(loop.decisions) - 1)
    for row, values, limits in zip(found, loop.decisions[rows].T[:known], RANGES, strict=False):
        np.testing.assert_allclose(row, kept_off_walls(values, *limits), rtol=1e-9)
    for row, default in zip(found[known:], DEFAULTS[known:], strict=False):
        assert row == pytest.approx([default] * len(KNOTS))


def test_a_search_starts_at_decisions_on_new_members_or_drops_those_it_does_not_decide(sourced_file):
    loop = make_controller(sourced_file)
    for action, count in (("sourced", 7), ("extended", 4), ("natural", 2)):
        space = KnotSpace(TuneConfig(action=action, start=sourced_file))
        found = decided_by(space.decode(space.start))
        assert len(found) == count
        for row, values, limits in zip(found, loop.decisions[list(KNOTS)].T, RANGES, strict=False):
            np.testing.assert_allclose(row, kept_off_walls(values, *limits), rtol=1e-9)


def test_points_cover_the_ranges_and_are_first_populations_too():
    space = KnotSpace(TuneConfig(action="sourced", knots=(0, 9)))
    assert len(space.start) == 7 * 2 + 3
    low, high = (space.decode(np.full(17, corner)) for corner in (0.0, 1.0))
    for decided, end in ((low, 0), (high, 1)):
        expected = [limits[end] for limits in RANGES]
        np.testing.assert_allclose(decided_by(decided), np.tile(expected, (2, 1)).T)
    assert (low.initial_population_size, low.first_source) == (2, Source(0.0, 0.01))
    assert (high.initial_population_size, high.first_source) == (200, Source(1.0, 1.0))
    point = np.random.default_rng(1).random(17)
    decided, loop = space.decode(point), space.controller(point)
    assert (loop.initial_population_size, loop.first_source) == (
        decided.initial_population_size,
        decided.first_source,
    )
    np.testing.assert_allclose(loop.decisions[[0, 9]].T, decided_by(decided), rtol=1e-12)


def test_candidates_meet_the_same_episodes_as_alone_whatever_their_first_population():
    config = TuneConfig(**TINY, action="sourced", initial_population_size=6)
    space = KnotSpace(config)
    points = np.random.default_rng(0).random((3, len(space.start)))
    points[2, -2] = 0.0  # a first population that is uniform
    loops = [space.controller(point) for point in (*points, points[0])]
    outcomes = SideBySide(config, 4, "paper", "sourced").run(loops, seed=TRAINING_START)
    np.testing.assert_array_equal(outcomes.losses[0], outcomes.losses[3])
    for row, loop in enumerate(loops[:3]):
        for episode, scenario in enumerate(outcomes.scenarios[row]):
            env = SwarmEnv(scenario=scenario, max_population_size=12, **loop.env_options())
            loop.reset(1)
            observation, info = env.reset(seed=TRAINING_START + episode)
            ended = False
            while not ended:
                observation, _, ended, _, info = env.step(loop.act(observation[None])[0])
            assert info["evaluations"] == outcomes.evaluations[row, episode]
            assert info["best_fitness"] == outcomes.final_fitness[row, episode]


@pytest.mark.parametrize("what", ["open-loop", "constant"])
def test_a_result_is_a_file_that_decides_what_the_search_found(tmp_path, what):
    run = tune(tmp_path, what=what, start="open-loop:three-cases-extended@0.1")
    path = run.run()
    loop, expected = make_controller(f"open-loop:{path}", run.config.limits), run.tuner.result()
    assert isinstance(loop, OpenLoop)
    np.testing.assert_array_equal(loop.decisions, expected.decisions)
    assert loop.action == "sourced"
    assert loop.env_options() == expected.env_options()
    content = json.loads(path.read_text())
    assert list(content["sources"]) == ["smooth_share", "amplitude", "immigrants"]
    assert content["first_source"] == {
        "smooth_share": expected.first_source.smooth_share,
        "amplitude": expected.first_source.amplitude,
    }
    assert content["first_source"] != {"smooth_share": 0.98, "amplitude": 0.5}  # the search has moved
    assert content["manifest"]["config"]["start"] == "open-loop:three-cases-extended@0.1"


def test_a_resumed_run_equals_one_that_was_not_stopped(tmp_path):
    whole = tune(tmp_path, rounds=3, name="whole").run()
    tune(tmp_path, rounds=1, name="stopped").run()
    resumed = tune(tmp_path, rounds=3, name="stopped", resume=True)
    assert resumed.tuner.rounds == 1
    assert resumed.run().read_text() == whole.read_text()


def test_held_decisions_keep_their_value_and_are_not_searched():
    free = KnotSpace(TuneConfig(action="sourced"))
    held = KnotSpace(TuneConfig(action="sourced", held=("immigrants=0", "noise=2.5", "first_smooth_share=1")))
    assert len(held.start) == len(free.start) - 2 * len(KNOTS) - 1
    point = np.random.default_rng(0).random(len(held.start))
    decided = held.decode(point)
    assert decided.sources["immigrants"] == [0.0] * len(KNOTS)
    assert decided.knobs["noise"] == [2.5] * len(KNOTS)
    assert decided.first_source.smooth_share == 1.0
    assert held.controller(point).names == free.controller(free.start).names
    np.testing.assert_allclose(held.decode(held.start).sizes, free.decode(free.start).sizes)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"held": ("immigrants=2",)}, r"immigrants must lie in \[0, 1\], got 2.0"),
        ({"held": ("courage=1",)}, "unknown parameter 'courage'; valid: .*first_amplitude"),
        ({"action": "natural", "held": ("immigrants=0",)}, "unknown parameter 'immigrants'"),
        ({"start": "fixed:5"}, "start must be none or an open loop, e.g. open-loop:three-.*'fixed:5'"),
        ({"start": "nonsense"}, "nonsense.*open-loop"),
        ({"start": "open-loop:nowhere"}, "nowhere.*three-cases"),
        ({"start": ""}, "unknown"),
        (
            {"start": "open-loop:three-cases-extended", "optimizer": "particle-swarm"},
            "decides noise, attractiveness, .*'particle-swarm' are inertia_factor, cognitive",
        ),
        ({"initial_smooth_share": 1.5}, r"smooth_share must lie in \[0, 1\], got 1.5"),
        ({"initial_amplitude": 0.0}, r"amplitude must lie in \[0.01, 1\], got 0.0"),
        ({"initial_population_size": 13}, "initial_population_size.*13"),
        ({"action": "extended", "initial_smooth_share": 0.5}, "initial_smooth_share needs action 'sourced'"),
        ({"action": "natural", "initial_amplitude": 0.3}, "initial_amplitude needs action .*, got 0.3"),
        ({"what": "schedule", "action": "natural", "candidates": 16, "initial_population_size": 60,
          "start": "open-loop:three-cases"}, "start: not an option of what 'schedule'"),
        ({"optimizer": "ant-colony"}, "action 'sourced'.*points of a walk"),
        ({"scenarios": ("function:rastrigin-3",)}, "action 'sourced'.*test functions"),
    ],
)  # fmt: skip
def test_options_that_cannot_be_are_refused_before_anything_is_written(tmp_path, options, message):
    with pytest.raises(ValueError, match=message):
        tune(tmp_path, **options)
    assert list(tmp_path.iterdir()) == []

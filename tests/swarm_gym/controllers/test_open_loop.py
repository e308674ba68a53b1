"""Open loops: what stands between the knots, what is refused, what is read back."""

import json
import math

import numpy as np
import pytest

from agents import SizeLimits
from helpers.slow import slow_but
from swarm_gym.controllers.knots import Knots
from swarm_gym.controllers.open_loop import (
    FORMAT,
    OPEN_LOOPS,
    OpenLoop,
    OpenLoopFileError,
    load_open_loop,
    save_open_loop,
)
from swarm_gym.controllers.packaged import read_json
from swarm_gym.env import SwarmEnv
from swarm_gym.optimizers.firefly import Firefly
from swarm_gym.rollout import run_episodes
from swarm_gym.sources import Source

KNOTS, SIZES, DEGREES = [0, 3, 8], [70.0, 30.0, 9.0], [0.0, 0.36, 0.04]
ONE = [0], [9.0], [0.5]
KNOBS = {"noise": [0.2, 5.0, 1.0], "attractiveness": [0.1, 0.4, 0.2]}
SOURCES = {"smooth_share": [1.0, 0.2, 0.6], "amplitude": [0.5, 0.01, 1.0], "immigrants": [0.0, 0.36, 1.0]}
ONE_OF_EACH = {"noise": [1.0], "attractiveness": [0.1]}


def between(knots, values, iteration):
    """Straight lines between knots, constant after the last one."""
    for (a, x), (b, y) in zip(
        zip(knots, values, strict=True), zip(knots[1:], values[1:], strict=False), strict=False
    ):
        if a <= iteration <= b:
            return x + (y - x) * (iteration - a) / (b - a)
    return values[-1]


def decided(loop, iterations):
    return loop.act(np.array([[0.0, 0.0, 0.0, iteration] for iteration in iterations]))


def test_a_stretched_loop_decides_at_eight_times_the_iteration_as_before():
    loop = OpenLoop(Knots(60, KNOTS, SIZES, DEGREES, KNOBS), SizeLimits(10, 50))
    longer = loop.stretched(8)
    assert longer.initial_population_size == 50
    assert decided(longer, range(0, 96, 8)) == pytest.approx(decided(loop, range(12)), rel=1e-12)
    assert decided(longer, [4])[0, 0] == pytest.approx(50.0)  # 70 members fall to 30, clipped
    assert loop.stretched(1).identity() == loop.identity() != longer.identity()
    assert list(loop.stretched(0.1).knots.iterations) == [0, 1, 2]
    with pytest.raises(ValueError, match="knots go up to"):
        loop.stretched(1e6)


def test_decisions_are_interpolated_in_logarithm_and_square_root():
    loop = OpenLoop(Knots(60, KNOTS, SIZES, DEGREES, KNOBS))
    for iteration, row in enumerate(decided(loop, range(12))):
        expected = [
            math.exp(between(KNOTS, [math.log(v) for v in SIZES], iteration)),
            between(KNOTS, [math.sqrt(v) for v in DEGREES], iteration) ** 2,
            *(math.exp(between(KNOTS, [math.log(v) for v in KNOBS[name]], iteration)) for name in KNOBS),
        ]
        assert row.tolist() == pytest.approx(expected, rel=1e-12)
    assert (loop.action, loop.initial_population_size) == ("extended", 60)
    assert OpenLoop(Knots(60, KNOTS, SIZES, DEGREES)).action == "natural"


def test_decisions_on_new_members_are_interpolated_each_on_its_scale():
    loop = OpenLoop(Knots(60, KNOTS, SIZES, DEGREES, KNOBS, sources=SOURCES, first_source=Source(1.0, 0.3)))
    for iteration, row in enumerate(decided(loop, range(12))):
        expected = [
            between(KNOTS, SOURCES["smooth_share"], iteration),
            math.exp(between(KNOTS, [math.log(v) for v in SOURCES["amplitude"]], iteration)),
            between(KNOTS, [math.sqrt(v) for v in SOURCES["immigrants"]], iteration) ** 2,
        ]
        assert row[4:].tolist() == pytest.approx(expected, rel=1e-12)
    np.testing.assert_array_equal(
        decided(loop, range(12))[:, :4], decided(OpenLoop(Knots(60, KNOTS, SIZES, DEGREES, KNOBS)), range(12))
    )
    assert loop.action == "sourced"
    options = loop.env_options()
    assert (options["source"], options["amplitude"]) == ("smooth", 0.3)


def test_an_episode_of_a_sourced_open_loop_begins_with_its_first_source():
    sources = {"smooth_share": [0.0, 0.5], "amplitude": [0.01, 1.0], "immigrants": [0.0, 1.0]}
    knobs = {"noise": [1.0] * 2, "attractiveness": [0.1] * 2}
    loop = OpenLoop(
        Knots(8, [0, 4], [8.0, 9.0], [0.0, 0.5], knobs, sources=sources, first_source=Source(0.5, 0.2))
    )
    env = SwarmEnv(iterations=6, **loop.env_options())
    observation, _ = env.reset(seed=1)
    assert env.simulation.swarms.source[0, :2].tolist() == [0.5, 0.2]
    loop.reset(1)
    for _ in range(6):
        observation, *_ = env.step(loop.act(observation[None])[0])
    np.testing.assert_array_equal(env.simulation.history[0, 1:, -3:], decided(loop, range(6))[:, -3:])


def test_sizes_keep_the_limits():
    loop = OpenLoop(Knots(60, KNOTS, SIZES, DEGREES), SizeLimits(12, 40))
    sizes = decided(loop, range(12))[:, 0]
    assert (sizes.min(), sizes.max(), loop.initial_population_size) == (12, 40, 40)


def test_one_knot_is_a_constant():
    np.testing.assert_array_equal(
        decided(OpenLoop(Knots(60, [0], [7.0], [0.25])), [0, 1, 99]), [[7.0, 0.25]] * 3
    )


def test_knobs_at_their_bounds_stay_inside():
    bounds = [parameter.decided for parameter in Firefly.decided_parameters().values()]
    names = list(Firefly.decided_parameters())
    for end in (0, 1):
        knobs = {name: [bound[end]] * 2 for name, bound in zip(names, bounds, strict=True)}
        loop = OpenLoop(Knots(60, [0, 4], [5.0, 5.0], [0.5, 1.0], knobs))
        run_episodes(loop, "case3", range(2), iterations=6)  # an action out of bounds is an error
    values = [x for x in np.random.default_rng(0).random(200) * 30 + 0.02 if np.exp(np.log(x)) > x]
    for value in values:
        knobs = {"noise": [value] * 2, "attractiveness": [0.1] * 2}
        assert decided(OpenLoop(Knots(60, [0, 5], [5.0] * 2, [0.5] * 2, knobs)), [0, 2])[:, 2].max() <= value


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (([0, 3], SIZES, DEGREES), "2 knots"),
        ((KNOTS, SIZES, [0.0]), "3 knots"),
        ((KNOTS, SIZES, DEGREES, {"noise": [1.0]}), "3 knots"),
        (([], [], []), "begin with 0"),
        (([1, 3, 8], SIZES, DEGREES), "begin with 0"),
        (([0, 3, 3], SIZES, DEGREES), "increase"),
        (([0, 2.5, 8], SIZES, DEGREES), "integers"),
        ((KNOTS, [70.0, 0.0, 9.0], DEGREES), "positive"),
        ((KNOTS, [70.0, math.nan, 9.0], DEGREES), "positive"),
        ((KNOTS, [70.0, math.inf, 9.0], DEGREES), "finite"),
        ((KNOTS, SIZES, DEGREES, {"noise": [1.0, -1.0, 1.0]}), "positive"),
        ((KNOTS, SIZES, [0.0, 1.1, 0.0]), "phi"),
        ((KNOTS, SIZES, [0.0, math.nan, 0.0]), "phi"),
        # Further decisions are those of the extended action.
        ((*ONE, {"attractiveness": [0.1], "noise": [1.0]}), "noise, attractiveness, in this order"),
        ((*ONE, {"nois": [1.0], "attractiveness": [0.1]}), "nois"),
        ((*ONE, {"noise": [1.0]}), "got noise"),
        ((*ONE, {"noise": [1e4], "attractiveness": [0.1]}), r"noise must lie in \[0.02, 100\]"),
    ],
)
def test_impossible_knots_are_refused(arguments, message):
    with pytest.raises(ValueError, match=message):
        Knots(60, *arguments)


WHOLE = {"smooth_share": [1.0], "amplitude": [0.5], "immigrants": [0.1]}
WRONG_SOURCES = [
    ({"smooth_share": [1.0], "amplitude": [0.5]}, "in this order; got smooth_share, amplitude"),
    ({name: WHOLE[name] for name in reversed(WHOLE)}, "in this order; got immigrants"),
    ({**WHOLE, "more": [1.0]}, "in this order; got .*more"),
    ({**WHOLE, "smooth_share": [1.1]}, r"smooth_share must lie in \[0, 1\], got 1.1"),
    ({**WHOLE, "amplitude": [0.0]}, r"amplitude must lie in \[0.01, 1\], got 0.0"),
    ({**WHOLE, "immigrants": [-0.5]}, r"immigrants must lie in \[0, 1\], got -0.5"),
    ({**WHOLE, "immigrants": [math.nan]}, "immigrants must lie in .*nan"),
    ({**WHOLE, "immigrants": [0.1, 0.2]}, "1 knots, but"),
    ({**WHOLE, "immigrants": []}, "1 knots, but"),
]


@pytest.mark.parametrize(("sources", "message"), WRONG_SOURCES)
def test_impossible_decisions_on_new_members_are_refused(sources, message):
    with pytest.raises(ValueError, match=message):
        Knots(60, *ONE, ONE_OF_EACH, sources=sources)


def test_decisions_on_new_members_need_those_of_the_optimizer():
    with pytest.raises(ValueError, match=r"further decisions of 'firefly' are noise, attractiveness"):
        Knots(60, *ONE, sources=WHOLE)


@pytest.mark.parametrize(
    "changes",
    [
        *({"sources": sources} for sources, _ in WRONG_SOURCES),
        *({"sources": value} for value in (None, [], {}, 3, "all", [1.0], {"smooth_share": 1.0})),
        *({"sources": {**WHOLE, "amplitude": value}} for value in (["a"], [None], 0.5, "a", [[0.5]])),
        {"knobs": {}},
        *({"first_source": value} for value in (None, [], {}, 0, "smooth", [1.0, 0.5])),
        {"first_source": {"smooth_share": 1.0}},
        {"first_source": {"smooth_share": 1.0, "amplitude": 0.5, "more": 1}},
        *(
            {"first_source": {"smooth_share": share, "amplitude": amplitude}}
            for share, amplitude in ((1.5, 1), (0.5, 0), (math.nan, 1), ("a", 1), (0.5, None), (True, 1))
        ),
    ],
)  # fmt: skip
def test_a_file_with_wrong_sources_is_refused_by_name(tmp_path, changes):
    path = tmp_path / "some.json"
    save_open_loop(path, Knots(60, *ONE, ONE_OF_EACH, WHOLE, Source(1.0, 0.5)), {})
    load_open_loop(str(path))
    path.write_text(json.dumps({**json.loads(path.read_text()), **changes}))
    with pytest.raises(OpenLoopFileError, match=r"some\.json"):
        load_open_loop(str(path))


def test_what_is_saved_is_read_back(tmp_path):
    path = tmp_path / "some.json"
    save_open_loop(path, Knots(60, KNOTS, SIZES, DEGREES, KNOBS), {"seed": 3})
    ours, theirs = OpenLoop(Knots(60, KNOTS, SIZES, DEGREES, KNOBS)), load_open_loop(str(path))
    np.testing.assert_array_equal(decided(ours, range(12)), decided(theirs, range(12)))
    assert json.loads(path.read_text())["manifest"] == {"seed": 3}


def test_sources_that_are_saved_are_read_back(tmp_path):
    path, first_source = tmp_path / "some.json", Source(0.25, 0.125)
    save_open_loop(path, Knots(60, KNOTS, SIZES, DEGREES, KNOBS, SOURCES, first_source), {})
    ours = OpenLoop(Knots(60, KNOTS, SIZES, DEGREES, KNOBS, sources=SOURCES, first_source=first_source))
    theirs = load_open_loop(str(path))
    np.testing.assert_array_equal(decided(ours, range(12)), decided(theirs, range(12)))
    assert theirs.first_source == first_source
    assert theirs.env_options() == ours.env_options()


@pytest.mark.parametrize("name", slow_but(OPEN_LOOPS.names()[::6], OPEN_LOOPS.names()))
def test_a_packaged_file_that_is_read_and_saved_again_stays_the_same(tmp_path, name):
    there, again = OPEN_LOOPS.find(name), tmp_path / "again.json"
    content = read_json(there, FORMAT)
    save_open_loop(again, Knots.read(content), content["manifest"])
    expected = there.read_text()
    if "optimizer" not in content:  # files of earlier versions are for fireflies
        first = f'"format": "{FORMAT}",\n'
        expected = expected.replace(first, f'{first}  "optimizer": "firefly",\n')
    assert again.read_text() == expected


def test_a_file_without_sources_has_none(tmp_path):
    path = tmp_path / "some.json"
    save_open_loop(path, Knots(60, KNOTS, SIZES, DEGREES, KNOBS), {})
    assert not {"sources", "first_source"} & set(json.loads(path.read_text()))
    loop = load_open_loop(str(path))
    assert (loop.first_source, "source" in loop.env_options()) == (None, False)


@pytest.mark.parametrize(
    "content",
    ["", "{", "[]", "3", '{"format": "other"}', '{"format": "swarm_gym open loop 1", "knots": [0]}',
     '{"format": "swarm_gym open loop 1", "knots": [0], "sizes": ["a"], "repair_degrees": [0], "knobs": {}}',
     '{"format": "swarm_gym open loop 1", "knots": [0], "sizes": [5], "repair_degrees": [2], "knobs": {}}'],
)  # fmt: skip
def test_a_file_that_is_no_open_loop_is_refused_by_name(tmp_path, content):
    path = tmp_path / "some.json"
    path.write_text(content)
    with pytest.raises(OpenLoopFileError, match=r"some\.json"):
        load_open_loop(str(path))


def test_a_missing_file_names_the_packaged_ones():
    with pytest.raises(OpenLoopFileError, match=r"nowhere.*three-cases, .*/\*@1, .*in all, see") as raised:
        load_open_loop("nowhere")
    assert "/0@" not in str(raised.value)  # one entry for all tuning seeds

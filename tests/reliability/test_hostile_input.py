"""Hostile input: only documented errors, in bounded time and memory; refused input changes nothing."""

import json
import math
import pickle
from contextlib import suppress
from functools import partial

import gymnasium
import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from agents import make_controller
from helpers.mutations import bounded_memory, fuzzed, mutated
from helpers.parsers import decides
from swarm_gym.controllers.distilled import DistilledFileError, packaged_rules
from swarm_gym.controllers.knots import MAX_KNOT
from swarm_gym.controllers.learned.policy_file import PolicyFileError
from swarm_gym.controllers.open_loop import OpenLoopFileError, packaged_open_loops
from swarm_gym.controllers.packaged import MAX_TEXT_FILE
from swarm_gym.controllers.tuned import TunedFileError, packaged_tuned
from swarm_gym.env import SwarmEnv
from swarm_gym.errors import (
    ActionError,
    ScenarioError,
    SettingError,
    StepOrderError,
    SwarmGymError,
    UnknownNameError,
)
from swarm_gym.optimizers import firefly  # noqa: F401, which takes seconds that no example shall wait for
from swarm_gym.scenarios import (
    FAMILIES,
    Appear,
    Circle,
    Disappear,
    Drive,
    DynamicScenario,
    FunctionScenario,
    Move,
    Polygon,
    Scenario,
    expand_name,
    make_scenario,
    sample_names,
)
from swarm_gym.scenarios.family import MAX_RANGE
from swarm_gym.scenarios.formats import moving_ai
from swarm_gym.scenarios.formats.moving_ai import MAX_PROBLEM_FILE, read_scenarios
from swarm_gym.training.presets import PRESETS, PresetError, load_preset
from swarm_gym.vector_env import SwarmVectorEnv

pytest.importorskip("PIL", reason="needs the extra `maps`")
pytest.importorskip("yaml", reason="needs the extra `maps`")

HUGE = 10**5000  # more digits than Python writes
ROS, MOVING_AI = "ros:small?start=0.5,0.5&goal=2.5,0.5", "moving-ai:small#0"  # names of maps in `folder`


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """Return a data folder with a map, beside a folder with the same map."""
    for name in ("data", "elsewhere"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "small.map").write_bytes(b"type octile\nheight 1\nwidth 3\nmap\n...\n")
        (tmp_path / name / "small.map.scen").write_bytes(b"version 1\n0\tsmall.map\t3\t1\t0\t0\t2\t0\t2\n")
        (tmp_path / name / "small.pgm").write_bytes(b"P5\n3 1\n255\n" + bytes([254] * 3))
        (tmp_path / name / "small.yaml").write_text(
            "image: small.pgm\nresolution: 1\norigin: [0, 0, 0]\nnegate: 0\n"
            "occupied_thresh: 0.6\nfree_thresh: 0.2"
        )
    monkeypatch.setenv("SWARM_GYM_DATA", str(tmp_path / "data"))
    return tmp_path / "data"


# Names.

PIECES = st.sampled_from(
    [*FAMILIES, *sample_names(), "train", "small", ":", "-", "0", "@", "#", "?start=", "&goal=", "0,0", "2,0",
     "1e9", "9" * 9, "9" * 12, "..", "/", "\\", "\0", "~", "-drive@1,every=1,distance=1", "shifted:", "P1"]
)  # fmt: skip
names = st.text(max_size=30) | st.lists(PIECES | st.text(max_size=3), max_size=8).map("".join)


@given(name=names)
@example(name="dynamic:" * 300 + "case1" + "-drive@1,every=1,distance=1" * 300)
@example(name="random-fields:train:0-999999")
@example(name="dynamic:random-fields:train:0-999999-drive@1,every=1,distance=1")
@example(name="function:easom-2-shifted:0-999999")
@example(name="dynamic:" + "-a" * 10_000)
@example(name="ros:" + "?start=" * 5_000)
@example(name="moving-ai:" + "#" * 10_000)
@fuzzed
def test_any_text_names_scenarios_or_is_refused(folder, name):
    with suppress(SwarmGymError):
        assert 0 < len(expand_name(name)) <= MAX_RANGE


@given(name=names)
@example(name="moving-ai:" + "a" * 5000 + "#0")
@example(name="ros:\ud800?start=0,0&goal=1,0")
@fuzzed
def test_any_text_makes_a_scenario_or_is_refused(folder, name):
    if not name.startswith(("block", "open", "dynamic:open")):  # up to 4000 x 4000 cells, which is intended
        with suppress(SwarmGymError):
            assert make_scenario(name).name == name


@pytest.mark.parametrize("name", ["case1", "rooms:0", "random-fields:train:3", MOVING_AI, ROS])
def test_names_of_scenarios_that_exist_are_taken(folder, name):
    assert expand_name(name) == (name,)
    assert make_scenario(name).name == name


@pytest.mark.parametrize(
    "family", ["random-fields:train:", "rooms:", "function:easom-2-shifted:", "moving-ai:a#"]
)
def test_a_range_that_is_short_is_taken(family):
    assert len(expand_name(f"{family}0-9")) == 10


@pytest.mark.parametrize(
    "family", ["random-fields:train:", "rooms:", "function:easom-2-shifted:", "moving-ai:a#"]
)
@pytest.mark.parametrize("numbers", ["0-99999999999", "0-999999999", f"0-{MAX_RANGE}", "5-1"])
def test_a_range_that_is_too_long_is_refused(family, numbers):
    with bounded_memory(), pytest.raises(ScenarioError):
        expand_name(family + numbers)


@pytest.mark.parametrize("name", [None, 3, [HUGE], b"case1", ["case1"], {}, float("nan"), ["a" * 10**6]])
def test_what_is_no_text_is_refused_shortly(name):
    with pytest.raises(SwarmGymError) as caught:
        make_scenario(name)
    assert len(str(caught.value)) < 2000


# Paths.


@pytest.mark.parametrize(
    "stem", ["../elsewhere/small", "movingai/../../elsewhere/small", "..", "./../elsewhere/small", "~/small"]
)
@pytest.mark.parametrize("name", [MOVING_AI, ROS])
def test_a_relative_name_does_not_leave_the_data_folder(folder, stem, name):
    with pytest.raises(ScenarioError):
        make_scenario(name.replace("small", stem))


@pytest.mark.parametrize("linked", ["file", "folder"])
def test_a_link_does_not_lead_out_of_the_data_folder(folder, linked):
    elsewhere = folder.parent / "elsewhere"
    if linked == "folder":
        (folder / "ros").symlink_to(elsewhere)
    for kind in ("map", "map.scen", "yaml", "pgm"):
        (folder / f"small.{kind}").unlink()
        if linked == "file":
            (folder / f"small.{kind}").symlink_to(elsewhere / f"small.{kind}")
    for name in (MOVING_AI, ROS):
        with pytest.raises(ScenarioError, match=f"leads out of the folder {folder}.*elsewhere"):
            make_scenario(name)


def test_a_link_within_the_data_folder_is_followed_and_that_may_be_a_link_itself(folder, monkeypatch):
    (folder / "ros").mkdir()
    (folder / "ros/other.map").symlink_to(folder / "small.map")
    (folder.parent / "link").symlink_to(folder)
    for data in (folder, folder.parent / "link"):
        monkeypatch.setenv("SWARM_GYM_DATA", str(data))
        for name in ("moving-ai:other?start=0,0&goal=2,0", MOVING_AI):
            assert make_scenario(name).target == (2.0, 0.0)


@pytest.mark.parametrize("image", ["/etc/hostname", "../elsewhere/small.pgm", "linked.pgm", "absolute"])
def test_the_image_of_a_map_is_in_its_folder(folder, image):
    other = folder.parent / "elsewhere/small.pgm"
    (folder / "linked.pgm").symlink_to(other)
    assert make_scenario(ROS).map.blocked.size == 3
    path = folder / "small.yaml"
    path.write_text(path.read_text().replace("small.pgm", str(other) if image == "absolute" else image))
    with pytest.raises(ScenarioError, match="folder"):
        make_scenario(ROS)


def test_the_map_that_a_problem_names_is_not_opened(folder):
    path = folder / "small.map.scen"
    path.write_bytes(path.read_bytes().replace(b"small.map", b"../../../etc/passwd"))
    assert make_scenario(MOVING_AI).map == make_scenario("moving-ai:small?start=0,0&goal=2,0").map


# Small files that ask for much memory or time.


def test_a_yaml_file_that_is_small_because_it_repeats_itself_is_refused(folder):
    lines = ["a0: &a0 [x, x, x, x, x, x, x, x, x, x]"]
    lines += [f"a{n}: &a{n} [{', '.join([f'*a{n - 1}'] * 10)}]" for n in range(1, 12)]
    path = folder / "small.yaml"
    path.write_text("\n".join([*lines, path.read_text().replace("[0, 0, 0]", "*a11")]))
    with bounded_memory(), pytest.raises(ScenarioError, match="origin must be"):
        make_scenario(ROS)


@pytest.mark.parametrize("line", [b"\n", b"a\n", b"ab\n", b"0\ta\t1\t1\t0\t0\t0\t0\t0\n", b"a"])
def test_a_long_file_of_problems_is_not_kept_in_memory(folder, line, monkeypatch):
    monkeypatch.setattr(moving_ai, "MAX_PROBLEMS", 1000)
    path = folder / "small.map.scen"
    assert len(read_scenarios(path)) == 1
    path.write_bytes(b"version 1\n" + line * ((MAX_PROBLEM_FILE - 10) // len(line)))
    with bounded_memory(2**21), pytest.raises(ScenarioError, match=r"line \d+"):
        read_scenarios(path)


# Parts of scenarios.

numbers = st.floats() | st.integers() | st.sampled_from([0.0, 1.0, 5e-324, 1e308, 1e9, 1e-9, HUGE, -HUGE])
things = numbers | st.none() | st.booleans() | st.text(max_size=3) | st.sampled_from(["1", b"2", [], {}, 1j])
points = st.tuples(things, things) | st.lists(things, max_size=3) | things
circles = st.tuples(things, things, things)
corners = st.lists(st.tuples(numbers, numbers), max_size=5) | things


@given(circle=circles, vertices=corners, extremes=st.tuples(things, things, things, things))
@example(circle=("1", "2", "3"), vertices=[(0, 0), (1e200, 0), (0, 1e200)], extremes=("a", 0, 1, 1))
@example(circle=(0, 0, HUGE), vertices=[(HUGE, 0)], extremes=(0, 0, HUGE, 1))
@fuzzed
def test_obstacles_of_anything_are_well_formed_or_refused(circle, vertices, extremes):
    for make in (lambda: Circle(*circle), lambda: Polygon(vertices), lambda: Polygon.rectangle(*extremes)):
        with suppress(ScenarioError):
            obstacle = make()
            assert math.isfinite(obstacle.depth((0.5, 0.5)))
            hash(obstacle)


@given(
    name=things, start=points, target=points, obstacles=st.lists(st.just(Circle(1, 1, 1)) | things) | things,
    workspace=st.tuples(things, things, things, things) | things, initial_range=points,
)  # fmt: skip
@example(
    name=HUGE, start=(0, 0), target=(1, 0), obstacles=[HUGE], workspace=(0, 0, 1, 1), initial_range=None
)  # fmt: skip
@fuzzed
def test_a_scenario_of_anything_is_well_formed_or_refused(**parts):
    with suppress(ScenarioError):
        made = Scenario(**parts)
        assert 0 < made.straight_line < np.inf


@given(dimension=things, optimum=st.lists(things, max_size=3).map(tuple) | things)
@fuzzed
def test_a_test_function_of_anything_is_well_formed_or_refused(dimension, optimum):
    with suppress(SwarmGymError):
        assert len(FunctionScenario("any", "easom", dimension, optimum).optimum) == dimension


events = st.sampled_from([Appear, Move, Disappear, Drive]).flatmap(
    lambda kind: st.tuples(*[things | st.integers(0, 3) | st.just(Circle(500, 500, 1))]
                           * (2 if kind in (Appear, Disappear) else 3)).map(lambda parts: (kind, parts))
)  # fmt: skip


@given(listed=st.lists(events, max_size=3))
@example(listed=[(Appear, (HUGE, None))])
@example(listed=[(Move, (1, 0, (1e9, 0))), (Move, (1, 0, (1e9, 0)))])
@fuzzed
def test_events_of_anything_happen_or_are_refused(listed):
    with suppress(SwarmGymError):
        made = [kind(*parts) for kind, parts in listed]
        drives = [event for event in made if isinstance(event, Drive)]
        happening = [event for event in made if not isinstance(event, Drive)]
        DynamicScenario("any", make_scenario("case1"), happening, drives[0] if drives else None)


def test_parts_of_scenarios_that_are_right_are_taken():
    circle = Circle(1, 2, 3.5)
    assert circle.depth((1.0, 2.0)) == 3.5
    for square in (Polygon(((0, 0), (2, 0), (2, 2), (0, 2))), Polygon.rectangle(0, 0, 2, 2)):
        assert square.depth((1.0, 1.0)) == 1.0
    made = Scenario("any", (-8, -8), (-5, -4), [circle], (-9, -9, 9, 9))
    assert made.straight_line == 5.0
    assert FunctionScenario("any", "easom", 2, (0.5, 0.5)).optimum == (0.5, 0.5)
    events = [Appear(10, Circle(500, 500, 1)), Move(20, 0, (600, 500)), Disappear(30, 0)]
    assert DynamicScenario("any", make_scenario("case1"), events, Drive(40, 5, 80.0)).events == tuple(events)


# Presets and controllers.

PRESET = b"seed = 3\n" + PRESETS.find("three-cases").read_bytes()
TOML = (b"[", b"{", b"=", b'"', b"'''", b"9" * 5000, b"nan", b"inf", b"[[a]]", b"1979-05-27",
        b"like = 'mine'")  # fmt: skip


@given(content=mutated(PRESET, *TOML) | st.binary(max_size=60))
@example(content=b"seed = " + b"9" * 5000)
@example(content=b"hidden_layers = " + b"[" * 5000)
@example(content=b"like = '" + b"a" * 5000 + b"'")
@example(content=b"#" * (MAX_TEXT_FILE + 1))
@example(content=b"a." * 2000 + b"a = 1")
@fuzzed
def test_a_preset_of_any_bytes_is_read_or_refused(tmp_path, content):
    (tmp_path / "mine.toml").write_bytes(content)
    with suppress(PresetError):
        load_preset(str(tmp_path / "mine.toml"))


def test_a_preset_that_is_right_is_read(tmp_path):
    (tmp_path / "mine.toml").write_bytes(PRESET)
    assert load_preset(str(tmp_path / "mine.toml")).seed == 3


def shipped_file(kind):
    from swarm_gym.controllers import distilled, open_loop, tuned

    kinds = {"open-loop": (open_loop.OPEN_LOOPS, packaged_open_loops()),
             "tuned": (tuned.TUNED, packaged_tuned()),
             "distilled": (distilled.DISTILLED, packaged_rules())}  # fmt: skip
    packaged, found = kinds[kind]
    name = next((name for name in found if name.startswith("three-cases")), found[0])
    return json.loads(packaged.find(name).read_text())


KINDS = {"open-loop": OpenLoopFileError, "tuned": TunedFileError, "distilled": DistilledFileError}
JSON = (b"null", b"-1", b"[", b"{", b'"', b"1e999", b"NaN", b"9" * 5000, b"9" * 18, b"0.5", b"[]", b"{}")


def decides_or_is_refused(name, error):
    # What a file of a tuned controller names may be unknown or out of range.
    with suppress(error, *((ValueError,) if error is TunedFileError else ())):
        decides(name)


json_values = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=5),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(max_size=5), inner, max_size=3),
    max_leaves=8,
)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.fuzzed
def test_whatever_a_file_says_it_is_a_controller_or_refused(tmp_path, kind):
    whole, path = shipped_file(kind), tmp_path / "some.json"
    short = {name: value for name, value in whole.items() if name != "manifest"}
    path.write_text(json.dumps(short))
    decides(f"{kind}:{path}")

    @given(content=mutated(json.dumps(short).encode(), *JSON) | st.binary(max_size=60))
    @example(content=b"[" * 100_000)
    @example(content=b"9" * 5000)
    @example(content=b" " * (MAX_TEXT_FILE + 1))
    @fuzzed
    def check_bytes(content):
        path.write_bytes(content)
        decides_or_is_refused(f"{kind}:{path}", KINDS[kind])

    more = ["first_source", "sources"] if kind == "open-loop" else []
    keys = st.sampled_from(sorted([*whole, *more]))

    @given(changes=st.dictionaries(keys, json_values, min_size=1, max_size=3))
    @example(changes={"knots": [0, 10**18]} if kind == "open-loop" else {})
    @example(changes={"knots": [0, 10**30]} if kind == "open-loop" else {})
    @example(
        changes={"first_source": {"smooth_share": 10**400, "amplitude": 1}} if kind == "open-loop" else {}
    )
    @example(changes={"sources": {"smooth_share": [0.5]}} if kind == "open-loop" else {})
    @example(changes={"initial_population_size": 40.5})
    @example(changes={"initial_population_size": float("nan")})
    @fuzzed
    def check_values(changes):
        path.write_text(json.dumps({**whole, **changes}))
        decides_or_is_refused(f"{kind}:{path}", KINDS[kind])

    check_bytes()
    check_values()


def test_knots_have_an_end(tmp_path):
    path = tmp_path / "some.json"
    whole = {"initial_population_size": 6, "sizes": [6, 9], "repair_degrees": [0, 1], "knobs": {}}
    path.write_text(json.dumps({**shipped_file("open-loop"), **whole, "knots": [0, MAX_KNOT + 1]}))
    with pytest.raises(OpenLoopFileError, match=f"knots go up to {MAX_KNOT}"):
        make_controller(f"open-loop:{path}")


@given(family=st.sampled_from(sorted({*KINDS, "learned", "fixed", "spsfa", "random"})), argument=names)
@example(family="learned", argument="a" * 5000)
@example(family="tuned", argument="a\0b")
@example(family="fixed", argument="9" * 5000)
@example(family="fixed", argument="\u00b2")
@fuzzed
def test_any_name_of_a_controller_is_one_or_refused(family, argument):
    with suppress(ValueError, PolicyFileError):
        make_controller(f"{family}:{argument}")


@pytest.mark.parametrize("name", ["learned:three-cases/0", "tuned:three-cases", "fixed:9", "spsfa", "random"])
def test_names_of_controllers_that_exist_are_taken(name):
    assert make_controller(name).initial_population_size >= 2


# Environments.

SMALL = {"initial_population_size": 4, "max_population_size": 6, "iterations": 3, "num_waypoints": 5}
MAKE = {"single": lambda: SwarmEnv(**SMALL), "vector": lambda: SwarmVectorEnv(2, **SMALL, num_threads=1)}
ALWAYS = {"single": np.array([4.0, 0.5]), "vector": np.tile([4.0, 0.5], (2, 1))}


class Stubborn:
    """An object that cannot be converted to an array."""

    def __array__(self, dtype=None, copy=None):
        raise RuntimeError("no")


class Mute(Stubborn):
    """An object whose repr fails."""

    def __repr__(self):
        raise RuntimeError("no")


def nested(depth):
    """Return a list in a list in a list, and so on."""
    value = []
    for _ in range(depth):
        value = [value]
    return value


DTYPES = ["f2", "f4", "f8", "g", "i1", "i8", "u8", "?", "c16", "U3", "S3", "O", "M8[s]", "m8[s]", "V4"]
shapes = st.lists(st.integers(0, 3), max_size=4).map(tuple)
arrays = st.builds(lambda dtype, shape: np.zeros(shape, dtype), st.sampled_from(DTYPES), shapes)
odd = st.sampled_from([Stubborn(), HUGE, [HUGE, 0], [[1, 2], [3]], {}, {1: 2}, object(), "4", b"4", range(2)])
vectors = st.lists(st.floats() | st.integers(), min_size=2, max_size=2).map(np.array)
anything = things | arrays | odd | vectors | st.lists(things, max_size=3)


def state_of(env):
    """Return all that the next steps depend on: populations, histories and random generators."""
    inner = env.simulation
    own = {name: value for name, value in vars(inner).items() if isinstance(value, np.ndarray)}
    seeds = {} if isinstance(env, SwarmEnv) else vars(env._seeds)
    generators = seeds.get("_generators", [env.np_random])
    ahead = [value for value in seeds.values() if isinstance(value, np.ndarray)]
    drawn = [generator.bit_generator.state for generator in generators]
    return pickle.dumps((tuple(inner.swarms), own, drawn, ahead))


@pytest.fixture(scope="module", params=MAKE)
def kind(request):
    return request.param


@pytest.fixture(scope="module")
def compiled(kind):
    env = MAKE[kind]()
    env.reset(seed=0)
    env.step(ALWAYS[kind])  # compiles here, so that no example has to wait
    return env


@pytest.fixture
def env(compiled):
    compiled.reset(seed=0)
    return compiled


def went_well(env, call, *documented):
    """Return True if a call succeeds; otherwise check the error, and that nothing has changed."""
    before = state_of(env)
    try:
        call()
    except documented as error:
        message = str(error)
    else:
        return True
    assert len(message) < 5000
    assert state_of(env) == before
    return False


def assert_as_good_as_new(kind, env):
    """Compare an environment that received hostile input with a new one."""
    new = MAKE[kind]()
    np.testing.assert_array_equal(env.reset(seed=1)[0], new.reset(seed=1)[0])
    np.testing.assert_array_equal(env.step(ALWAYS[kind])[0], new.step(ALWAYS[kind])[0])


@pytest.mark.fuzzed
def test_any_action_is_taken_or_refused_and_then_nothing_has_changed(kind, env):
    @given(action=anything | st.tuples(anything, anything).map(list))
    @example(action=np.array([np.longdouble("1e4000"), 0]))
    @example(action=np.ma.masked_array([4.0, 0.5], [True, False]))
    @fuzzed
    def check(action):
        if went_well(env, lambda: env.step(action), ActionError, StepOrderError):
            env.reset(seed=0)  # so that no episode ends

    assert went_well(env, lambda: env.step(ALWAYS[kind]), ActionError)
    check()
    assert_as_good_as_new(kind, env)


# Objects that cannot be printed, also not by Hypothesis.
@pytest.mark.parametrize("make", [Mute, lambda: nested(5000), lambda: [HUGE]], ids=["mute", "deep", "huge"])
def test_what_cannot_be_shown_is_refused(kind, env, make):
    assert not went_well(env, lambda: env.step(make()), ActionError)
    for wrong in (make(), {"initial_population": make()}, {"scenario": make()}, {"more": make()}):
        call = partial(env.reset, options=wrong)
        assert not went_well(env, call, SettingError, UnknownNameError)
    if kind == "vector":
        assert not went_well(env, lambda: env.reset(seed=make()), SettingError, gymnasium.error.Error)


KEYS = st.sampled_from(
    ["scenario", "initial_population_size", "initial_population", "smooth_share", "amplitude", "reset_mask",
     "more", 3, None]
)  # fmt: skip
options = st.dictionaries(KEYS, anything | st.sampled_from(["case1", "case2", 4, 5, 7, 1, 0.5]), max_size=3)


@pytest.mark.fuzzed
def test_any_reset_options_are_taken_or_refused_and_then_nothing_has_changed(kind, env):
    @given(
        seed=anything | st.integers(0, 3) | st.lists(st.integers() | st.none(), max_size=2),
        given=options | anything,
    )
    @example(seed=None, given={"initial_population": np.full((4, 5), np.longdouble("1e4000"))})
    @example(seed=None, given={"initial_population": [[HUGE] * 5] * 4})
    @example(seed=None, given={"initial_population": Stubborn()})
    @example(seed=None, given={"scenario": np.array(["case1", "case1"])})
    @example(seed=None, given=np.zeros(3))
    @example(seed=1.5, given=None)
    @example(seed=-HUGE, given=None)
    @example(seed=np.zeros(()), given=None)
    @example(seed=5, given={"scenario": "case9"})
    @example(seed=5, given={"smooth_share": HUGE, "amplitude": 0.5})
    @example(seed=5, given={"smooth_share": np.longdouble("1e-4000"), "amplitude": Stubborn()})
    @example(seed=[3, -1], given=None)
    @fuzzed
    def check(seed, given):
        documented = SettingError, UnknownNameError, gymnasium.error.Error
        went_well(env, lambda: env.reset(seed=seed, options=given), *documented)

    assert went_well(env, lambda: env.reset(seed=3, options={"scenario": "case1"}), SettingError)
    check()
    assert_as_good_as_new(kind, env)

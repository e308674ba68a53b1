"""The published file of 56 terrains: converted without running its code, then read by name."""

import pickle
import sys
from io import BytesIO

import numpy as np
import pytest

from swarm_gym.errors import ScenarioError
from swarm_gym.scenarios import expand_name, make_scenario
from swarm_gym.scenarios.terrain import convert_uav56
from swarm_gym.scenarios.terrain.safe_pickle import load_arrays

SIDE = 40


def terrain(number):
    """Return a terrain with the names and shapes of the published file."""
    heights = np.arange(SIDE * SIDE, dtype=np.float64).reshape(SIDE, SIDE) / 7.0 + number
    return {
        "drone_size": 1.0,
        "threats": np.array([[20.0, 20.0, 100.0, 5.0]]),
        "start": np.array([[3.0], [4.0], [150.0]]),
        "end": np.array([[37.0], [36.0], [150.0]]),
        "zmin": np.float64(100.0),
        "MAPSIZE_X": float(SIDE),
        "H": np.asfortranarray(heights),
    }


@pytest.mark.parametrize("protocol", [2, 3, 4, 5])
def test_a_file_is_converted_and_read_by_name(tmp_path, monkeypatch, capsys, protocol):
    monkeypatch.setenv("SWARM_GYM_DATA", str(tmp_path))
    path = tmp_path / "Model56.pkl"
    path.write_bytes(pickle.dumps({number: terrain(number) for number in range(56)}, protocol))
    assert convert_uav56.main([str(path)]) == 0
    assert "56 terrains written to" in capsys.readouterr().out
    scenario = make_scenario("uav56:7")
    assert np.array_equal(scenario.heights, terrain(7)["H"])
    assert (scenario.start, scenario.goal) == ((3.0, 4.0, 150.0), (37.0, 36.0, 150.0))
    assert scenario.origin == (1.0, 1.0)
    assert scenario.threats.tolist() == [[20.0, 20.0, np.inf, 5.0]]
    assert len(expand_name("uav56:0-55")) == 56


def test_old_names_of_numpy_are_known(tmp_path):
    path = tmp_path / "a.pkl"
    content = pickle.dumps({"a": np.arange(3.0)}, 2)
    assert b"numpy._core" in content or b"numpy.core" in content
    path.write_bytes(content.replace(b"numpy._core", b"numpy.core"))
    assert load_arrays(path)["a"].tolist() == [0.0, 1.0, 2.0]


class Calls:
    """An object whose pickle calls a function when it is read."""

    def __init__(self, function, *arguments):
        self.call = function, arguments

    def __reduce__(self):
        return self.call


@pytest.mark.parametrize(
    "content",
    [
        pickle.dumps(Calls(sys.setrecursionlimit, 999)),
        pickle.dumps(Calls(eval, "1 + 1")),
        pickle.dumps(Calls(np.load, "x.npy")),
        pickle.dumps(Calls(np.ndarray, (10**15,))),
        pickle.dumps(Calls(np.dtype, "O")),
        pickle.dumps(np.array([None, 1], dtype=object)),
        pickle.dumps({0: pytest.approx}),
        pickle.dumps(np.ma.array([1, 2], mask=[0, 1])),
        b"cos\nsystem\n(S'echo no'\ntR.",
        b"cbuiltins\nexec\n(S'1'\ntR.",
        pickle.dumps(np.arange(9.0))[:-20],
        b"",
        b"not a pickle",
    ],
)
def test_whatever_is_no_array_is_refused(tmp_path, content):
    path = tmp_path / "a.pkl"
    path.write_bytes(content)
    with pytest.raises(ScenarioError, match="refused as a pickle of arrays"):
        load_arrays(path)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ([terrain(0)] * 3, "expected 56 terrains"),
        ({number: terrain(number) for number in range(1, 57)}, "terrain 0 is missing"),
        ([{"H": np.eye(3)}] * 56, "terrain 0 has no 'threats'"),
        ([terrain(0) | {"H": {"a": 1}}] * 56, "terrain 0: H must be numbers"),
    ],
)
def test_a_file_with_other_terrains_is_refused(tmp_path, content, message):
    path = tmp_path / "a.pkl"
    path.write_bytes(pickle.dumps(content))
    with pytest.raises(ScenarioError, match=message):
        convert_uav56.converted(path)


def test_a_missing_or_damaged_file_says_how_to_make_it(tmp_path, monkeypatch):
    monkeypatch.setenv("SWARM_GYM_DATA", str(tmp_path))
    with pytest.raises(ScenarioError, match=r"convert_uav56 Model56\.pkl` makes it"):
        make_scenario("uav56:0")
    (tmp_path / "uav56.npz").write_bytes(b"PK and no more")
    with pytest.raises(ScenarioError, match="make it again"):
        make_scenario("uav56:0")
    with pytest.raises(ScenarioError, match="a number from 0 to 55"):
        make_scenario("uav56:56")


@pytest.mark.parametrize("damage", ["half", "bytes", "array"])
def test_a_file_that_is_damaged_later_says_how_to_make_it(tmp_path, monkeypatch, damage):
    monkeypatch.setenv("SWARM_GYM_DATA", str(tmp_path))
    path, file = tmp_path / "Model56.pkl", tmp_path / "uav56.npz"
    path.write_bytes(pickle.dumps({number: terrain(number) for number in range(56)}))
    convert_uav56.main([str(path)])
    content = bytearray(file.read_bytes())
    if damage == "half":
        del content[len(content) // 2 :]
    elif damage == "bytes":
        content[100:400] = bytes(300)
    else:
        alone = BytesIO()
        np.save(alone, np.zeros(3))
        content = bytearray(alone.getvalue())
    file.write_bytes(content)
    with pytest.raises(ScenarioError, match="make it again"):
        make_scenario("uav56:0")


@pytest.mark.parametrize(
    ("part", "values", "message"),
    [
        ("threats", np.ones((3, 2)), r"terrain 0: threats must be any x 4 numbers, .* \(3, 2\)"),
        ("H", np.ones(9), "heights must be any x any numbers"),
        ("start", np.ones(2), "start must be 3 numbers"),
    ],
)
def test_arrays_of_other_shapes_are_refused(tmp_path, monkeypatch, part, values, message):
    path = tmp_path / "Model56.pkl"
    path.write_bytes(pickle.dumps({number: {**terrain(number), part: values} for number in range(56)}))
    with pytest.raises(ScenarioError, match=message):
        convert_uav56.converted(path)
    good = terrain(0)
    names = {"heights": "H", "threats": "threats", "start": "start", "goal": "end"}
    arrays = {f"{name}_0": np.asarray(good[own] if own != part else values) for name, own in names.items()}
    np.savez(
        tmp_path / "uav56.npz",
        **{
            name: found.ravel() if name.startswith(("start", "goal")) else found
            for name, found in arrays.items()
        },
    )
    monkeypatch.setenv("SWARM_GYM_DATA", str(tmp_path))
    with pytest.raises(ScenarioError, match=f"{message}.*make it again"):
        make_scenario("uav56:0")


def test_the_command_ends_with_a_line_for_a_bad_file(tmp_path):
    with pytest.raises(SystemExit, match=r"error: .*cannot be read"):
        convert_uav56.main([str(tmp_path / "none.pkl"), "--output", str(tmp_path / "out.npz")])
    assert not (tmp_path / "out.npz").exists()

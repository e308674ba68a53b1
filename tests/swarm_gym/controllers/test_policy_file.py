"""Policy files that are damaged, mismatched or hostile: an error that says so, or one that can decide."""

import hashlib
import json
import struct
from contextlib import suppress

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from agents import make_controller
from helpers.mutations import fuzzed, mutated
from helpers.trainings import add_choices, add_memory, change_policy, make_policy
from swarm_gym.controllers.knots import Knots
from swarm_gym.controllers.learned.policy_file import (
    MAX_FILE,
    MAX_HEADER,
    MAX_WEIGHT,
    PolicyFileError,
    encode_policy,
    load_policy,
    packaged_policies,
    resolve,
    save_policy,
)
from swarm_gym.controllers.open_loop import save_open_loop
from swarm_gym.controllers.registry import load_learned
from swarm_gym.controllers.tuned import TunedFileError, save_tuned
from swarm_gym.optimizers import firefly  # noqa: F401, which takes seconds that no example shall wait for

FEATURES, SIZE = 9, 3
OBSERVATION = np.linspace(-1, 1, 4 * FEATURES, dtype=np.float32).reshape(4, FEATURES)


@pytest.fixture
def policy(tmp_path):
    """Return the file of a policy that is taken as it stands."""
    path = make_policy(tmp_path / "some.safetensors", np.random.default_rng(0))
    assert decides_or_is_refused(path)
    return path


def with_memory(path):
    return add_memory(path, np.random.default_rng(1), SIZE)


def with_choices(path):
    return add_choices(path, np.random.default_rng(1), SIZE)


def refused(path, *expected):
    with pytest.raises(PolicyFileError) as caught:
        load_learned(path)
    for text in (str(path), *expected):
        assert text in str(caught.value)
    return str(caught.value)


def decides_or_is_refused(path):
    with suppress(PolicyFileError):
        controller = load_learned(path)
        controller.reset(len(OBSERVATION))
        assert (np.abs(controller.act(OBSERVATION)) <= 1).all()
        return True
    return False


def file_of(header, tensors=b""):
    return struct.pack("<Q", len(header)) + header + tensors


def parts_of(data):
    """Return the header and the tensors of a file."""
    end = 8 + struct.unpack("<Q", data[:8])[0]
    return data[8:end], data[end:]


def test_every_packaged_policy_loads_and_is_far_below_the_limits():
    for name in packaged_policies():
        load_policy(resolve(name))
        data = resolve(name).read_bytes()
        assert len(data) < MAX_FILE / 100, name
        assert struct.unpack("<Q", data[:8])[0] < MAX_HEADER / 100, name


# The file.


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"", "announces 0"),
        (struct.pack("<Q", 2**63), str(2**63)),
        (struct.pack("<Q", 100) + b"{}", "announces 100"),
        (struct.pack("<Q", MAX_HEADER + 1) + bytes(MAX_HEADER + 1), f"up to {MAX_HEADER}"),
        (file_of(b"[]"), "got []"),
        (file_of(b"{}"), "expected format"),
        (file_of(b"[" * 100_000), "recursion"),
        (file_of(b'{"a": ' + b"9" * 5000 + b"}"), "4300"),
        (file_of(b'{"__metadata__": 3}'), "not a readable"),
        (file_of(b'{"__metadata__": {"manifest": 3}}'), "not a readable"),
        (file_of(b'{"__metadata__": {"manifest": "{"}}'), "not a readable"),
        (file_of(b'{"__metadata__": {"manifest": "' + b"[" * 100_000 + b'"}}'), "recursion"),
        (file_of(b"\xff\xfe"), "not a readable"),
        (bytes(MAX_FILE + 1), f"at most {MAX_FILE} bytes"),
        (b"PK\x03\x04 a zip file, say, that would be unpickled elsewhere", "agents.import_sb3"),
        (file_of(b'{"__metadata__": {"manifest": "[1]"}}'), "format"),
    ],
)
def test_a_file_that_is_no_policy_is_refused(tmp_path, content, message):
    path = tmp_path / "some.safetensors"
    path.write_bytes(content)
    refused(path, message)


@pytest.mark.parametrize("kept", [0, 4, 100, -1])
def test_a_truncated_policy_is_refused(policy, kept):
    policy.write_bytes(policy.read_bytes()[:kept])
    refused(policy)


def test_a_tampered_policy_is_refused(policy):
    data = bytearray(policy.read_bytes())
    data[-3] ^= 1
    policy.write_bytes(bytes(data))
    refused(policy, "digest")


def test_what_is_no_regular_file_is_refused(tmp_path):
    with pytest.raises(PolicyFileError, match="regular"):
        load_policy(tmp_path)
    for name in ("a" * 5000, "a\0b", str(tmp_path)):
        with pytest.raises(PolicyFileError, match="neither"):
            make_controller(f"learned:{name}")


INSERTIONS = (b"null", b"-1", b"9" * 30, b"[", b"{", b'"', b"1e999", b"NaN", b"\\u0000", b"\0" * 8)


@pytest.mark.parametrize("network", ["feedforward", "lstm", "choices"])
@pytest.mark.fuzzed
def test_any_bytes_are_a_policy_or_refused(policy, network):
    change = {"feedforward": lambda path: path, "lstm": with_memory, "choices": with_choices}
    data = change[network](policy).read_bytes()
    assert decides_or_is_refused(policy)
    header, tensors = parts_of(data)

    @given(
        content=mutated(data, *INSERTIONS)
        | mutated(header, *INSERTIONS).map(lambda changed: file_of(changed, tensors))
        | st.integers(0, 2**64 - 1).map(lambda announced: struct.pack("<Q", announced) + data[8:])
        | st.binary(max_size=60)
    )
    @fuzzed
    def check(content):
        policy.write_bytes(content)
        decides_or_is_refused(policy)

    check()


# Tensors.


@pytest.mark.parametrize(
    ("name", "tensor"),
    [
        ("0.weight", np.zeros((8, FEATURES), np.float64)),
        ("0.weight", np.zeros((8, FEATURES), np.int8)),
        ("0.weight", np.zeros((FEATURES, 8), np.float32)),
        ("0.weight", np.zeros((8, FEATURES + 1), np.float32)),
        ("0.weight", np.zeros(8 * FEATURES, np.float32)),
        ("0.bias", np.zeros(0, np.float32)),
        ("1.bias", np.zeros((2, 1), np.float32)),
        ("2.bias", np.zeros(2, np.float32)),
        ("another", np.zeros(2, np.float32)),
        ("0.bias", np.array([*[0] * 7, np.nan], np.float32)),
        ("0.bias", np.array([*[0] * 7, np.inf], np.float32)),
        ("0.bias", np.array([*[0] * 7, -2 * MAX_WEIGHT], np.float32)),
    ],
)
def test_another_tensor_than_the_manifest_implies_is_refused(policy, name, tensor):
    change_policy(policy, weights={name: tensor})
    refused(policy, "tensor", name)


def test_tensors_that_share_bytes_are_refused(policy):
    header, tensors = parts_of(policy.read_bytes())
    header = json.loads(header)
    header["0.bias"]["data_offsets"] = header["1.bias"]["data_offsets"]
    policy.write_bytes(file_of(json.dumps(header).encode(), tensors))
    refused(policy, "not a readable")


def test_the_largest_weights_that_are_allowed_decide_without_overflow(policy):
    weights, _ = load_policy(policy)
    change_policy(policy, {name: np.full_like(array, MAX_WEIGHT) for name, array in weights.items()})
    assert decides_or_is_refused(policy)
    change_policy(
        with_memory(policy), {"lstm.weight": np.full((4 * SIZE, FEATURES + SIZE), -MAX_WEIGHT, np.float32)}
    )
    assert decides_or_is_refused(policy)


# The manifest.


VALUES = {
    "action": [None, "natural", "extended", ["normalised"]],
    "base": [3, "", "nothing", "learned", "learned:three-cases/0", "open-loop:none", "fixed:" + "1" * 10**4],
    "config": [[]],
    "corrected_from": [-1, 1.0],
    "features": ["abc", [], [3] * FEATURES, ["a"] * FEATURES, ["a"] * 10**4],
    "hidden_layers": [8, ["8"], [True], [8.0], [-8], [10**30], [8] * 1000],
    "initial_population_size": ["80", None, 1, 201, float("nan")],
    "manifest_sha256": [3],
    "max_evaluations": [79, "many"],
    "max_population_size": [1, 10**12],
    "min_population_size": [0, {}],
    "network": [None],
    "num_decisions": [0, True, 10**9],
    "observation": ["paper+", "+".join(["extended"] * 10**4), None],
    "optimizer": ["bees", []],
    "price": [0.5, [2, 1], [float("nan")], ["1"], []],
    "weights_sha256": ["0" * 63],
}


def write_manifest(policy, **changes):
    """Write a policy with other values in its manifest, whose digest is right."""
    header, tensors = parts_of(policy.read_bytes())
    header = json.loads(header)
    manifest = json.loads(header["__metadata__"]["manifest"])
    del manifest["manifest_sha256"]
    manifest |= changes
    digest = hashlib.sha256(json.dumps(manifest, sort_keys=True).encode()).hexdigest()
    header["__metadata__"]["manifest"] = json.dumps({"manifest_sha256": digest, **manifest})
    policy.write_bytes(file_of(json.dumps(header).encode(), tensors))


@pytest.mark.parametrize(("key", "value"), [(key, value) for key in VALUES for value in VALUES[key]])
def test_a_value_that_nothing_can_be_done_with_is_refused(policy, key, value):
    write_manifest(policy, **{key: value})
    assert len(refused(policy, key)) < 2000 + len(str(policy))


def test_other_values_that_something_can_be_done_with_are_taken(policy):
    write_manifest(policy, initial_population_size=70, max_population_size=90, price=[0.5, 1.0])
    assert decides_or_is_refused(policy)


@pytest.mark.parametrize(
    ("key", "value", "message"),
    [
        ("observation", "everything", "everything"),
        ("action", "raw", "raw"),
        ("features", ["temperature"], "temperature"),
        ("hidden_layers", [9], "tensor '0.weight'"),
        ("hidden_layers", [8, 8], "tensor '1.weight'"),
        ("max_population_size", 50, "50"),
    ],
)
def test_a_policy_for_something_else_is_refused(policy, key, value, message):
    change_policy(policy, **{key: value})
    refused(policy, message)


def test_an_action_layout_of_more_decisions_is_refused(policy):
    change_policy(policy, action="extended-normalised")
    refused(policy, "num_decisions must be 4", "attractiveness")
    change_policy(policy, action="paced", max_evaluations=None)
    refused(policy, "max_evaluations")


def test_a_policy_that_sees_a_price_says_which(tmp_path):
    path = make_policy(tmp_path / "some.safetensors", np.random.default_rng(0), observation="priced")
    refused(path, "price must be", "None")
    make_policy(path, np.random.default_rng(0), observation="priced", price=[0.0, 1.0])
    refused(path, "price must be", "[0.0, 1.0]")
    make_policy(path, np.random.default_rng(0), observation="priced", price=[0.5, 1.0])
    load_learned(path)


def test_a_missing_tensor_is_refused_and_a_memory_without_a_size(policy):
    weights, manifest = load_policy(policy)
    del weights["1.bias"]
    save_policy(policy, weights, manifest)
    refused(policy, "tensor '1.bias'", "got 'none'")
    make_policy(policy, np.random.default_rng(0))
    weights, manifest = load_policy(with_memory(policy))
    save_policy(policy, weights, {**manifest, "lstm_size": None})
    refused(policy, "lstm_size", "None")
    for key in ("lstm_size", "initial_population_size"):
        save_policy(policy, weights, {name: manifest[name] for name in manifest if name != key})
        refused(policy, f"lacks {key}")


@pytest.mark.parametrize("number", [None, 0, SIZE + 1, 10**9])
def test_a_file_with_another_number_of_choices_than_it_says_is_refused(policy, number):
    weights, manifest = load_policy(with_choices(policy))
    save_policy(policy, weights, {**manifest, "num_choices": number})
    refused(policy, "tensor 'choices'" if number == SIZE + 1 else "num_choices")


def test_more_may_be_said_than_is_needed(policy):
    change_policy(policy, notes={"made by": ["somebody", None, 1.5, {"unicode": "\u00e9\ud800"}]})
    assert decides_or_is_refused(policy)


def test_a_manifest_that_was_changed_is_refused(policy):
    data, size = policy.read_bytes(), b'\\"initial_population_size\\": 8'
    assert data.count(size) == 1
    policy.write_bytes(data.replace(size + b"0", size + b"1"))
    refused(policy, "manifest does not match its own digest")


def test_a_file_without_a_digest_of_its_manifest_is_refused(policy):
    data = policy.read_bytes()
    begin = data.index(b'\\"manifest_sha256\\"')
    header, tensors = parts_of(data)
    policy.write_bytes(file_of(header[: begin - 8] + header[data.index(b", ", begin) + 2 - 8 :], tensors))
    refused(policy, "lacks manifest_sha256")


json_values = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=20)
    | st.sampled_from(["none", "lstm", "natural", "paced", "spsfa", "tuned:x", "extended+paper", "priced"]),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(max_size=5), inner, max_size=3),
    max_leaves=8,
)  # fmt: skip
KEYS = (
    "action", "base", "config", "corrected_from", "features", "format", "hidden_layers",
    "initial_population_size", "lstm_size", "manifest_sha256", "max_evaluations", "max_population_size",
    "min_population_size", "network", "num_decisions", "observation", "optimizer", "price", "weights_sha256",
)  # fmt: skip


@given(changes=st.dictionaries(st.sampled_from(KEYS), json_values, min_size=1, max_size=3))
@example(changes={"price": [1e309]})
@example(changes={"observation": "priced", "price": [0]})
@fuzzed
def test_whatever_a_manifest_says_it_is_a_policy_or_refused(policy, changes):
    weights = {"0.weight": np.ones((2, FEATURES), np.float32), "0.bias": np.ones(2, np.float32)}
    features = load_policy(make_policy(policy, np.random.default_rng(0)))[1]
    policy.write_bytes(encode_policy(weights, {**features, "hidden_layers": [], **changes}))
    decides_or_is_refused(policy)


def test_a_policy_of_one_layer_is_a_policy(policy):
    weights = {"0.weight": np.ones((2, FEATURES), np.float32), "0.bias": np.ones(2, np.float32)}
    policy.write_bytes(encode_policy(weights, {**load_policy(policy)[1], "hidden_layers": []}))
    assert decides_or_is_refused(policy)


# Files that name files.


def proposing(policy, feature):
    """Return weights and manifest of a policy that sees a proposed size and one more feature."""
    weights, manifest = load_policy(policy)
    weights["0.weight"] = np.zeros((8, FEATURES + 2), np.float32)
    manifest["features"] += ["proposed population size", feature]
    return weights, manifest


def test_files_that_name_each_other_are_refused(policy, tmp_path):
    tuned = tmp_path / "some.json"
    save_tuned(tuned, f"learned:{policy}", {})
    weights, manifest = proposing(policy, "proposed repair degree")
    save_policy(policy, weights, {**manifest, "base": f"tuned:{tuned}"})
    refused(policy, "base", "tuned")
    with pytest.raises(TunedFileError, match="learned"):
        make_controller(f"tuned:{tuned}")
    save_policy(policy, weights, {**manifest, "base": f"learned:{policy}"})
    refused(policy, "base must be", "no policy itself")


def test_features_are_those_of_layout_and_base(policy, tmp_path):
    loop = tmp_path / "loop.json"
    save_open_loop(loop, Knots(6, [0, 9], [6.0, 9.0], [0.1, 0.7]), {})
    weights, manifest = proposing(policy, "proposed everything")
    save_policy(policy, weights, {**manifest, "base": f"open-loop:{loop}"})
    refused(policy, "trained with observation features")

"""Policies as ONNX models decide as the NumPy forward pass does."""

import json

import numpy as np
import pytest

from agents.export_onnx import STATE, main, to_onnx
from helpers.trainings import add_memory, make_policy
from swarm_gym.controllers.learned.policy_file import load_policy
from swarm_gym.controllers.registry import load_learned
from swarm_gym.observation import ITERATION

onnx = pytest.importorskip("onnx", reason="needs the extra `onnx`")
reference = pytest.importorskip("onnx.reference", reason="needs the extra `onnx`")

SIZE = 5


@pytest.fixture
def policy(tmp_path):
    return make_policy(tmp_path / "some.safetensors", np.random.default_rng(0))


@pytest.fixture
def remembering(policy):
    """A policy with an LSTM before its layers."""
    return add_memory(policy, np.random.default_rng(1), SIZE)


def observations(policy, count, rng):
    features = len(load_policy(policy)[1]["features"])
    return rng.normal(size=(count, features)).astype(np.float32)


def test_the_model_decides_as_the_controller(policy, tmp_path):
    main([str(policy), str(tmp_path / "some.onnx")])
    model = onnx.load(tmp_path / "some.onnx")
    seen = observations(policy, 200, np.random.default_rng(2))
    (decided,) = reference.ReferenceEvaluator(model).run(None, {"observation": seen})
    assert np.abs(decided).min() < 0.9  # not all are clipped
    np.testing.assert_allclose(decided, load_learned(policy).act(seen), rtol=0, atol=1e-6)


def test_the_model_of_a_memory_decides_as_the_controller_step_by_step(remembering):
    session = reference.ReferenceEvaluator(to_onnx(*load_policy(remembering)))
    controller, rng = load_learned(remembering), np.random.default_rng(3)
    controller.reset(7)
    state = [np.zeros((7, SIZE), np.float32)] * 2
    for step in range(6):
        seen = observations(remembering, 7, rng)
        seen[:, ITERATION] = step
        decided, *state = session.run(None, {"observation": seen, **dict(zip(STATE, state, strict=True))})
        np.testing.assert_allclose(decided, controller.act(seen), rtol=0, atol=1e-6)


def test_the_model_holds_the_manifest(policy):
    weights, manifest = load_policy(policy)
    held = {entry.key: entry.value for entry in to_onnx(weights, manifest).metadata_props}
    assert json.loads(held["manifest"]) == manifest


def test_a_policy_that_there_is_not_is_refused(tmp_path):
    with pytest.raises(SystemExit, match="error: policy 'nowhere'"):
        main(["nowhere", str(tmp_path / "some.onnx")])
    assert not (tmp_path / "some.onnx").exists()

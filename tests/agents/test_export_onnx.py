"""Policies as ONNX models decide as the NumPy forward pass does."""

import json

import numpy as np
import pytest

from agents.export_onnx import STATE, main
from helpers.trainings import add_choices, add_memory, make_policy
from swarm_gym.controllers.learned.policy_file import load_policy
from swarm_gym.controllers.registry import load_learned
from swarm_gym.observation import ITERATION

onnx = pytest.importorskip("onnx", reason="needs the extra `onnx`")
reference = pytest.importorskip("onnx.reference", reason="needs the extra `onnx`")

SIZE = 5


@pytest.fixture(params=["feedforward", "lstm", "choices"])
def policy(tmp_path, request):
    path = make_policy(tmp_path / "some.safetensors", np.random.default_rng(1))
    change = {"feedforward": lambda path, *_: path, "lstm": add_memory, "choices": add_choices}
    return change[request.param](path, np.random.default_rng(2), SIZE)


def test_the_model_decides_as_the_controller_step_by_step_and_holds_the_manifest(policy, tmp_path):
    main([str(policy), str(tmp_path / "some.onnx")])
    model, manifest = onnx.load(tmp_path / "some.onnx"), load_policy(policy)[1]
    session, controller = reference.ReferenceEvaluator(model), load_learned(policy)
    controller.reset(200)
    state = {name: np.zeros((200, SIZE), np.float32) for name in STATE if name in session.input_names}
    rng = np.random.default_rng(3)
    for step in range(6):
        seen = rng.normal(size=(200, len(manifest["features"]))).astype(np.float32)
        seen[:, ITERATION] = step / 10
        decided, *after = session.run(None, {"observation": seen, **state})
        state = dict(zip(state, after, strict=True))
        assert np.abs(decided).min() < 0.9  # not all are clipped
        np.testing.assert_allclose(decided, controller.act(seen), rtol=0, atol=1e-6)
    held = {entry.key: entry.value for entry in model.metadata_props}
    assert json.loads(held["manifest"]) == manifest


def test_a_policy_that_there_is_not_is_refused(tmp_path):
    with pytest.raises(SystemExit, match="error: policy 'nowhere'"):
        main(["nowhere", str(tmp_path / "some.onnx")])
    assert not (tmp_path / "some.onnx").exists()

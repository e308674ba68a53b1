"""Policies that stable-baselines3 saved become policy files, and no code of theirs runs."""

import base64
import io
import json
import pickle
import zipfile

import gymnasium
import numpy as np
import pytest
from gymnasium.spaces import Box

from agents.import_sb3 import main
from swarm_gym.controllers.learned.policy_file import load_policy
from swarm_gym.controllers.registry import load_learned
from swarm_gym.rollout import run_episodes
from swarm_gym.sb3 import make_vec

torch = pytest.importorskip("torch")
stable_baselines3 = pytest.importorskip("stable_baselines3")
from stable_baselines3.common.torch_layers import BaseFeaturesExtractor  # noqa: E402 (where there is one)
from stable_baselines3.common.vec_env import VecNormalize  # noqa: E402

FEATURES = 9  # of the layout `extended`


class Nothing(gymnasium.Env):
    """Spaces like those of the project's environments."""

    observation_space = Box(-1, 1, (FEATURES,), np.float32)
    action_space = Box(-1, 1, (2,), np.float32)

    def reset(self, *, seed=None, options=None):
        return np.zeros(FEATURES, np.float32), {}

    def step(self, action):
        return np.zeros(FEATURES, np.float32), 0.0, True, False, {}


class Malicious:
    """Pickled, it is a call that writes a file."""

    def __init__(self, path):
        self.path = str(path)

    def __reduce__(self):
        return exec, (f"open({self.path!r}, 'w').close()",)


LAYOUTS = ["--observation", "extended", "--action", "normalised"]


def saved(folder, env=None, **options):
    """A model of random weights, saved."""
    model = stable_baselines3.PPO(
        "MlpPolicy", env or Nothing(), n_steps=8, batch_size=8, seed=0, device="cpu", policy_kwargs=options
    )
    model.save(folder / "some.zip")
    return model, folder / "some.zip"


@pytest.fixture
def zipped(tmp_path):
    return saved(tmp_path, net_arch=[8, 6])[1]


def rewritten(path, **members):
    """The zip with other members, by name up to the dot."""
    with zipfile.ZipFile(path) as archive:
        content = {name: archive.read(name) for name in archive.namelist()}
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in content.items():
            archive.writestr(name, members.get(name.partition(".")[0], data))
    return path


def data_of(path):
    with zipfile.ZipFile(path) as archive:
        return json.loads(archive.read("data"))


@pytest.mark.parametrize("net_arch", [[8, 6], [], None])
def test_the_policy_decides_as_the_model(tmp_path, net_arch):
    model, path = saved(tmp_path, **({} if net_arch is None else {"net_arch": net_arch}))
    output = tmp_path / "some.safetensors"
    main([str(path), str(output), *LAYOUTS])
    seen = np.random.default_rng(0).normal(size=(50, FEATURES)).astype(np.float32)
    expected = model.predict(seen, deterministic=True)[0]
    np.testing.assert_allclose(load_learned(output).act(seen), expected, rtol=0, atol=1e-6)
    manifest = load_policy(output)[1]
    assert manifest["hidden_layers"] == ([64, 64] if net_arch is None else net_arch)
    assert manifest["imported_from"] == "some.zip"
    assert sorted(tmp_path.iterdir()) == [output, path]


def test_layouts_and_sizes_are_those_of_the_environment(tmp_path):
    sizes = {"initial_population_size": 6, "min_population_size": 3, "max_population_size": 12}
    _, path = saved(tmp_path, make_vec(num_envs=2, action="extended-centred", max_evaluations=900, **sizes))
    main([str(path), str(tmp_path / "a.safetensors")])
    expected = {"observation": "extended", "action": "extended-centred", "optimizer": "firefly"}
    manifest = load_policy(tmp_path / "a.safetensors")[1]
    assert {**expected, **sizes, "max_evaluations": 900}.items() <= manifest.items()
    main([str(path), str(tmp_path / "b.safetensors"), "--initial-population-size", "7"])
    assert load_policy(tmp_path / "b.safetensors")[1]["initial_population_size"] == 7


def test_a_model_that_corrects_a_controller_is_imported_with_it(tmp_path):
    swarms = make_vec(num_envs=3, base="open-loop:three-cases", iterations=6, scenario="case3")
    model, path = saved(tmp_path, swarms)
    main([str(path), str(tmp_path / "a.safetensors")])
    assert load_policy(tmp_path / "a.safetensors")[1]["base"] == "open-loop:three-cases"
    swarms.seed(0)
    seen = swarms.reset()
    for _ in range(6):
        seen, _, _, infos = swarms.step(model.predict(seen, deterministic=True)[0])
    runs = run_episodes(load_learned(tmp_path / "a.safetensors"), "case3", range(3), iterations=6)
    np.testing.assert_allclose(runs.final_fitness, [info["best_fitness"] for info in infos], rtol=1e-5)
    np.testing.assert_array_equal(runs.evaluations, [info["evaluations"] for info in infos])


@pytest.mark.parametrize(
    "options",
    [
        {
            "base": "fixed:9,smooth_share=0.5,amplitude=0.1",
            "max_evaluations": 40,
            "initial_population_size": 9,
        },
        {"source": "smooth", "amplitude": 0.07, "initial_population_size": 9},
        {"action": "sourced-centred", "initial_population_size": 9},
    ],
)
def test_first_members_are_those_of_the_environment(tmp_path, options):
    swarms = make_vec(num_envs=3, iterations=6, scenario="case3", **options)
    model, path = saved(tmp_path, swarms)
    main([str(path), str(tmp_path / "a.safetensors")])
    swarms.seed(0)
    seen = swarms.reset()
    ended = {}
    for _ in range(6):
        seen, _, dones, infos = swarms.step(model.predict(seen, deterministic=True)[0])
        for row in np.flatnonzero(dones):
            ended.setdefault(row, infos[row]["best_fitness"])
    runs = run_episodes(load_learned(tmp_path / "a.safetensors"), "case3", range(3), iterations=6)
    np.testing.assert_allclose(runs.final_fitness, [ended[row] for row in range(3)], rtol=1e-5)


@pytest.mark.parametrize(
    ("made_for", "message"),
    [
        (None, "does not say with which observation layout .*--observation; extended has 9 inputs"),
        ({"observation": "extended"}, "does not say with which action layout .*--action"),
        ({"observation": 3, "action": "centred"}, "observation must be .* str, got 3"),
        (
            {"observation": "extended", "action": "centred", "min_population_size": "2"},
            "type int, got '2'",
        ),
        (
            {"observation": "extended", "action": ["centred"]},
            r"action must be .* str, got \['centred'\]",
        ),
    ],
)
def test_what_a_zip_says_of_its_environment_is_checked(zipped, made_for, message):
    data = data_of(zipped)
    data["action_space"]["made_for"] = made_for
    rewritten(zipped, data=json.dumps(data).encode())
    output = zipped.with_name("refused.safetensors")
    with pytest.raises(SystemExit, match=message):
        main([str(zipped), str(output)])
    assert not output.exists()


def refused(path, message, *options):
    output = path.with_name("refused.safetensors")
    with pytest.raises(SystemExit, match=message):
        main([str(path), str(output), *LAYOUTS, *options])
    assert list(path.parent.glob("refused*")) == []


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (
            ["--observation", "rich"],
            "the policy has 9 inputs, .*'rich' has 13 features; .*--observation; extended has 9",
        ),
        (["--observation", "everything"], "unknown observation layout 'everything'"),
        (["--action", "natural"], "action must be one of .*normalised.*'natural'"),
        (["--action", "extended-normalised"], "num_decisions must be 4"),
        (["--action", "paced"], "max_evaluations"),
        (["--initial-population-size", "300"], "initial_population_size must be .*300"),
        (["--min-population-size", "0"], "population sizes must satisfy"),
        (["--optimizer", "bees"], "optimizer must be one of .*firefly.*'bees'"),
    ],
)
def test_options_that_do_not_fit_are_refused(zipped, options, message):
    refused(zipped, message, *options)


def test_another_activation_is_refused(tmp_path):
    refused(saved(tmp_path, activation_fn=torch.nn.ReLU)[1], "activation_fn Tanh, got .*ReLU")


class Weighted(BaseFeaturesExtractor):
    """A features extractor with weights."""

    def __init__(self, space):
        super().__init__(space, 3)
        self.layer = torch.nn.Linear(FEATURES, 3)

    def forward(self, seen):
        return self.layer(seen)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"use_sde": True, "squash_output": True}, "its actions are squashed"),
        ({"features_extractor_class": Weighted}, r"features extractor has weights of its own \(features"),
    ],
)
def test_what_else_changes_observations_or_actions_is_refused(tmp_path, options, message):
    sde = options.pop("use_sde", False)
    model = stable_baselines3.PPO(
        "MlpPolicy", Nothing(), use_sde=sde, n_steps=8, batch_size=8, device="cpu", policy_kwargs=options
    )
    model.save(tmp_path / "some.zip")
    refused(tmp_path / "some.zip", message, *LAYOUTS)


def test_observations_that_were_normalised_are_refused(tmp_path):
    swarms = VecNormalize(make_vec("firefly", 2, scenario="case1", iterations=4), norm_obs=False)
    model = stable_baselines3.PPO("MlpPolicy", swarms, n_steps=4, batch_size=8, seed=0, device="cpu")
    model.learn(8)
    model.save(zipped := tmp_path / "some.zip")
    refused(zipped, "within VecNormalize, whose statistics of observations the zip lacks")
    main([str(zipped), str(tmp_path / "mine.safetensors"), "--observations-as-they-are"])
    seen = np.random.default_rng(0).random((5, model.observation_space.shape[0]), np.float32)
    expected = np.clip(model.predict(seen, deterministic=True)[0], -1.0, 1.0)
    np.testing.assert_allclose(load_learned(tmp_path / "mine.safetensors").act(seen), expected, atol=1e-6)


def test_pickles_beside_the_weights_are_left_alone(zipped, tmp_path):
    data, mark = data_of(zipped), tmp_path / "ran"
    for entry in data.values():
        if isinstance(entry, dict) and ":serialized:" in entry:
            entry[":serialized:"] = base64.b64encode(pickle.dumps(Malicious(mark))).decode()
    rewritten(zipped, data=json.dumps(data).encode())
    main([str(zipped), str(tmp_path / "some.safetensors"), *LAYOUTS])
    assert not mark.exists()
    load_learned(tmp_path / "some.safetensors")


@pytest.mark.parametrize("legacy", [False, True])
def test_weights_that_hold_code_run_it_only_where_that_is_asked_for(zipped, tmp_path, legacy):
    content, mark = io.BytesIO(), tmp_path / "ran"
    with zipfile.ZipFile(zipped) as archive:
        state = torch.load(io.BytesIO(archive.read("policy.pth")), weights_only=True)
    torch.save({**state, "more": Malicious(mark)}, content, _use_new_zipfile_serialization=not legacy)
    rewritten(zipped, policy=content.getvalue())
    refused(zipped, "may run code from the zip.*--trust-pickle")
    assert not mark.exists()
    main([str(zipped), str(tmp_path / "some.safetensors"), *LAYOUTS, "--trust-pickle"])
    assert mark.exists()  # the marker would tell


@pytest.mark.parametrize(
    ("members", "message"),
    [
        ({"policy": b""}, "unreadable weights"),
        ({"policy": b"\x80\x04]."}, "unreadable weights|more than tensors"),
        ({"data": b"{"}, "not a zip"),
        ({"data": b"[" * 100_000}, "not a zip"),
        ({"data": b"[]"}, "activation_fn"),
        ({"data": b'{"policy_kwargs": {"activation_fn": 3}}'}, "activation_fn"),
        ({"policy": b"\0" * 2**20}, "unpack at most"),
    ],
)
def test_a_damaged_zip_is_refused(zipped, members, message, monkeypatch):
    monkeypatch.setattr("agents.import_sb3.MAX_UNPACKED", 2**19)
    refused(rewritten(zipped, **members), message)


def with_state(path, state):
    content = io.BytesIO()
    torch.save(state, content)
    return rewritten(path, policy=content.getvalue())


@pytest.mark.parametrize(
    "state",
    [
        {},
        {"action_net.weight": torch.zeros(2, 9)},
        {"action_net.weight": torch.zeros(2, 9, dtype=torch.bfloat16), "action_net.bias": torch.zeros(2)},
        {"action_net.weight": torch.zeros(1).expand(10**6, 10**6), "action_net.bias": torch.zeros(2)},
        {"action_net.weight": "nothing", "action_net.bias": torch.zeros(2)},
    ],
)
def test_weights_of_another_network_are_refused(zipped, state):
    refused(with_state(zipped, state), "expected an MlpPolicy")


@pytest.mark.parametrize("kept", [0, 100, -1])
def test_a_truncated_zip_is_refused(zipped, kept):
    zipped.write_bytes(zipped.read_bytes()[:kept])
    refused(zipped, "not a zip")

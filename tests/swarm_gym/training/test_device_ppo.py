"""PPO on the tensors of one device: the numbers are those of PPO, and what it does not have is refused."""

import numpy as np
import pytest
import torch
from gymnasium.vector import AutoresetMode

from helpers.loops import looped
from helpers.trainings import EVOLUTION, STEPS, filled_buffer, run_whole_and_stopped, tiny_config, train
from swarm_gym.controllers.learned.residual import carried_out as carried_out_on_arrays
from swarm_gym.controllers.registry import load_learned
from swarm_gym.training.learners import make_learner
from swarm_gym.training.learners.clipped_update import Steps, update
from swarm_gym.training.learners.device_base import TensorBase, carried_out
from swarm_gym.training.learners.device_ppo import DevicePPOLearner
from swarm_gym.training.learners.device_rollout import DeviceSwarms, run_episode
from swarm_gym.training.learners.environments import make_swarms
from swarm_gym.training.learners.group_advantages import advantages_and_returns
from swarm_gym.training.learners.ppo import PPOLearner

pytestmark = pytest.mark.usefixtures("little_imitation", "plain_pictures")

CPU = torch.device("cpu")
DEVICE = {"algorithm": "device-ppo", "warm_start": "none"}
LOOP = {"base": "open-loop:three-cases", "max_population_size": 200, "initial_population_size": 60}
HELD = {
    **LOOP, "group_size": 2, "reward": "optimality", "noise_steps": 0, "critic": False, "gae_lambda": 1.0,
    "price": (0.3, 5.0), "observation": "priced", "corrected_from": 80, "log_std": -2.0,
}  # fmt: skip
CUDA_IS_FOR = "device 'cuda' is for algorithm 'device-ppo' only, got "
EACH_STEP = {"base": "spsfa", "group_size": 2, "reward": "optimality", "branches": (60, 85)}


def both(folder, **options):
    """Return the learners of PPO and of PPO on a device, with equal options and untrained."""
    made = [
        make_learner(tiny_config(folder, **{**DEVICE, **options, "algorithm": name}))
        for name in ("ppo", "device-ppo")
    ]
    assert isinstance(made[0], PPOLearner)
    assert isinstance(made[1], DevicePPOLearner)
    return made


def draw_minibatches_as(learner, monkeypatch):
    """Draw minibatches as the library does in that learner: by NumPy, all steps of the first swarm first."""

    def same_order(number, **_):
        swarm, step = np.divmod(np.random.permutation(number), learner.model.n_steps)  # noqa: NPY002
        return torch.as_tensor(step * learner.config.num_swarms + swarm)

    monkeypatch.setattr(torch, "randperm", same_order)


@looped("group_size", [1, 2, 6])
@looped("noise_steps", [0, 1, 3])
@pytest.mark.parametrize(("critic", "gae_lambda", "discount"), [(False, 1.0, 1.0), (True, 0.9, 0.97)])
def test_advantages_and_returns_are_those_of_the_buffer(
    group_size, noise_steps, critic, gae_lambda, discount
):
    rng = np.random.default_rng(2)
    rewards, values = rng.normal(size=(2, 7, 6)).astype(np.float32)
    buffer = filled_buffer(
        rewards, values, gae_lambda=gae_lambda, gamma=discount, group_size=group_size, critic=critic,
        noise_steps=noise_steps,
    )  # fmt: skip
    advantages, returns = advantages_and_returns(
        torch.as_tensor(rewards), torch.as_tensor(values) if critic else None, discount=discount,
        gae_lambda=gae_lambda, group_size=group_size, noise_steps=noise_steps,
    )  # fmt: skip
    np.testing.assert_allclose(advantages.numpy(), buffer.advantages, atol=1e-6)
    np.testing.assert_allclose(returns.numpy(), buffer.returns, atol=1e-6)


@pytest.mark.parametrize("name", ["open-loop:three-cases", "spsfa"])
def test_a_base_proposes_the_same_for_tensors_as_for_arrays(tmp_path, name):
    options = {**DEVICE, **HELD, "base": name, "corrected_from": 4}
    # Two bases, since a schedule remembers what it has proposed.
    (env, base), (_, other) = (
        make_swarms(tiny_config(tmp_path, **options), 4, AutoresetMode.DISABLED) for _ in range(2)
    )
    on_device = TensorBase(other, CPU)
    base.controller.reset(4)
    on_device.reset(4)
    observations, _ = env.reset(seed=3)
    generator = np.random.default_rng(0)
    for _ in range(8):
        corrections = generator.normal(size=(4, 2)).astype(np.float32)
        proposal = base.propose(observations)
        proposed = on_device.propose(torch.as_tensor(observations))
        wanted = carried_out_on_arrays(corrections, proposal)
        actions = carried_out(torch.as_tensor(corrections), proposed).numpy()
        np.testing.assert_allclose(proposed.seen.numpy(), proposal.seen, atol=1e-6)
        np.testing.assert_allclose(actions, wanted, atol=1e-6)
        observations = env.unwrapped.step_running(actions)[0]


@pytest.mark.parametrize(
    "options",
    [HELD, EACH_STEP, {**EACH_STEP, "base": "none", "branches": (), "gae_lambda": 0.9, "discount": 0.99}],
    ids=["noise is held", "noise of each step", "no base"],
)
def test_a_rollout_and_its_update_are_those_of_ppo(tmp_path, options, monkeypatch):
    """With the same minibatches, both learners end with the same weights."""
    options = {**options, "batch_size": 30, "epochs": 3, "target_kl": 10.0}
    theirs, ours = both(tmp_path, **options)
    start = theirs.model.policy.state_dict()
    assert all(torch.equal(start[name], tensor) for name, tensor in ours.policy.state_dict().items())
    if not theirs.config.algorithm.critic:  # begins equally; with a critic, imitations differ
        for learner in (theirs, ours):
            learner.begin()
    before = {name: tensor.clone() for name, tensor in ours.policy.state_dict().items()}
    scalars = theirs.learn(7)
    draw_minibatches_as(theirs, monkeypatch)
    found = ours.learn(7)
    assert found["rollout/ep_rew_mean"] == pytest.approx(scalars["rollout/ep_rew_mean"], rel=1e-9)
    assert found["train/n_updates"] == scalars["train/n_updates"] == 3
    after = ours.policy.state_dict()
    for name, tensor in theirs.model.policy.state_dict().items():
        torch.testing.assert_close(after[name], tensor, rtol=0.0, atol=1e-6)
    assert (after["action_net.weight"] - before["action_net.weight"]).abs().max() > 1e-4


def test_an_update_stops_where_that_of_ppo_stops(tmp_path, monkeypatch):
    options = {**HELD, "batch_size": 10, "epochs": 5, "learning_rate": 0.01, "target_kl": 0.02}
    theirs, ours = both(tmp_path, **options)
    scalars = theirs.learn(7)
    draw_minibatches_as(theirs, monkeypatch)
    found = ours.learn(7)
    assert found["train/n_updates"] == scalars["train/n_updates"] < 5
    after = ours.policy.state_dict()
    for name, tensor in theirs.model.policy.state_dict().items():
        torch.testing.assert_close(after[name], tensor, rtol=0.0, atol=1e-6)


@pytest.mark.parametrize(("noise_steps", "drawn"), [(0, [0] * 7), (3, [0, 0, 0, 3, 3, 3, 6])])
def test_noise_is_held_for_its_steps(tmp_path, noise_steps, drawn):
    """One matrix, times the last hidden layer, explains the noise of all steps that share it."""
    config = tiny_config(tmp_path, **{**DEVICE, **HELD, "corrected_from": 93, "hidden_layers": (2,)})
    learner = make_learner(config.changed(noise_steps=noise_steps))
    rollout = run_episode(
        learner.policy, learner.swarms, np.random.default_rng(0), critic=False, noise_steps=noise_steps
    )
    assert len(rollout.rewards) == len(drawn)
    with torch.no_grad():
        flat = rollout.observations.flatten(0, 1)
        hidden = learner.policy.mlp_extractor.forward_actor(flat).unflatten(0, (7, 4)).double()
        mean = learner.policy.get_distribution(flat).mode().unflatten(0, (7, 4))
    noise = (rollout.actions - mean).double()
    for begin in sorted(set(drawn)):
        rows = [step for step, first in enumerate(drawn) if first == begin]
        if len(rows) < 3:
            continue
        for swarm in range(4):
            solved = torch.linalg.lstsq(hidden[rows, swarm], noise[rows, swarm]).solution
            rest = hidden[rows, swarm] @ solved - noise[rows, swarm]
            assert rest.abs().max() < 1e-4 < noise[rows, swarm].abs().max()


def test_swarms_of_a_group_differ_only_from_their_branch_on_and_returns_are_those_of_episodes(tmp_path):
    config = tiny_config(tmp_path, **{**DEVICE, **HELD, "corrected_from": 90})
    env, base = make_swarms(config, 4, AutoresetMode.DISABLED)
    swarms = DeviceSwarms(env, TensorBase(base, CPU), 2, (90,), CPU)
    asked = []

    def decide(seen):
        asked.append(seen)
        return torch.zeros(4, 2)

    seen, num_steps = swarms.begin(np.random.default_rng(1), decide)
    assert len(asked) == 90
    assert num_steps == 2 * 90
    assert torch.equal(seen[0], seen[1])
    assert not torch.equal(seen[1], seen[2])
    assert torch.equal(swarms.returns[::2], swarms.returns[1::2])
    returns = swarms.returns.clone()
    for _ in range(10):
        seen, rewards = swarms.step(torch.tensor([[0.5, 0.0], [-0.5, 0.0]] * 2))
        returns += rewards
    assert not torch.equal(seen[0], seen[1])
    assert torch.equal(returns, swarms.returns)
    simulation = env.unwrapped.simulation
    assert not simulation.running.any()
    evaluations = simulation.swarms.evaluations
    assert evaluations[0] != evaluations[1]


class OfTensors:
    """Swarms that take and return tensors, the same ones in every step, as those on a device may do."""

    def __init__(self, env):
        self._env, self.num_envs, self.unwrapped = env, env.num_envs, self
        self.settings = env.unwrapped.settings
        self._kept = {}

    def _keep(self, name, array):
        kept = self._kept.setdefault(name, torch.empty(array.shape, dtype=torch.as_tensor(array).dtype))
        return kept.copy_(torch.as_tensor(array))

    def reset(self, **options):
        observations, infos = self._env.reset(**options)
        return self._keep("observations", observations), infos

    def copy_swarms(self, rows):
        return self._keep("observations", self._env.unwrapped.copy_swarms(rows))

    def step_running(self, actions, chosen=None):
        assert isinstance(actions, torch.Tensor)
        found = self._env.unwrapped.step_running(actions.numpy(), chosen)
        return tuple(map(self._keep, ("observations", "rewards", "ended"), found))


@pytest.mark.parametrize("base", ["open-loop:three-cases", "none"])
def test_an_environment_of_tensors_gives_the_rollout_of_one_of_arrays(tmp_path, base):
    config = tiny_config(tmp_path, **{**DEVICE, **HELD, "base": base, "branches": (80,), "corrected_from": 0})
    rollouts = []
    for wrap in (lambda env: env, OfTensors):
        learner = make_learner(config)
        env, made = make_swarms(config, 4, AutoresetMode.DISABLED)
        swarms = DeviceSwarms(wrap(env), made and TensorBase(made, CPU), 2, (80,), CPU)
        torch.manual_seed(1)
        generator = np.random.default_rng(2)
        rollouts.append(run_episode(learner.policy, swarms, generator, critic=True, noise_steps=0))
    one, other = rollouts
    assert one.num_steps == other.num_steps == 4 * 20 + 2 * 80
    for ours, theirs in zip(one[:-1], other[:-1], strict=True):
        assert torch.equal(ours, theirs)


@pytest.mark.parametrize(
    "options",
    [
        {**HELD, "averaging": 0.5, "branches": (85, 95), "decay_steps": 4 * STEPS},
        pytest.param({**EACH_STEP, "noise_steps": 4}, marks=pytest.mark.slow),
    ],
    ids=["held noise", "base on the host"],
)
def test_a_resumed_run_equals_one_that_was_not_stopped(tmp_path, options):
    one, other = run_whole_and_stopped(tmp_path, 1, STEPS, **{**DEVICE, **options})
    ours, theirs = (run.learner.policy.state_dict() for run in (one, other))
    assert all(torch.equal(ours[name], theirs[name]) for name in ours)
    assert one.learner._passes == other.learner._passes > 0


def test_a_policy_file_decides_as_the_learner_does(tmp_path):
    run = train(tmp_path, total_steps=1, **{**DEVICE, **HELD, "averaging": 0.0})
    run.run()
    controller = load_learned(tmp_path / "ppo" / "latest.safetensors", run.config.limits)
    learner = run.learner
    env, base = make_swarms(run.config, 4, AutoresetMode.DISABLED)
    controller.reset(4)
    observations, _ = env.reset(seed=5)
    on_device = TensorBase(base, CPU)
    for _ in range(85):
        proposal = on_device.propose(torch.as_tensor(observations))
        with torch.no_grad():
            actions = carried_out(learner.policy.get_distribution(proposal.seen).mode(), proposal).numpy()
        np.testing.assert_allclose(controller.act(observations), actions, atol=1e-5)
        observations = env.unwrapped.step_running(actions)[0]


def test_the_policy_is_the_running_mean_of_the_weights(tmp_path):
    options = {**DEVICE, **HELD, "corrected_from": 90, "rollouts_per_chunk": 1}
    last, mean = (make_learner(tiny_config(tmp_path, **options, averaging=share)) for share in (0.0, 0.5))
    found = []
    for chunk in range(2):
        last.learn(chunk)
        mean.learn(chunk)
        found.append(last.weights())
    for name, array in mean.weights().items():
        np.testing.assert_allclose(array, 0.5 * found[0][name] + 0.5 * found[1][name], atol=1e-6)
    assert any((found[0][name] != found[1][name]).any() for name in found[0])


def test_a_critic_with_a_base_begins_with_returns_of_the_base(tmp_path, monkeypatch):
    monkeypatch.setattr("swarm_gym.training.imitation.GRADIENT_STEPS", 300)
    learner = make_learner(tiny_config(tmp_path, **{**DEVICE, "base": "spsfa", "branches": (80,)}))
    observed = learner._roll(np.random.default_rng(5))
    wanted = observed.rewards.flip(0).cumsum(0).flip(0)

    def error():
        with torch.no_grad():
            return (learner.policy.predict_values(observed.observations.flatten(0, 1)).flatten()
                    - wanted.flatten()).square().mean().item()  # fmt: skip

    untrained = error()
    learner.begin()
    assert error() < 0.5 * untrained
    assert not learner.policy.action_net.weight.any()
    assert learner.num_steps == 0


def test_an_update_moves_towards_praised_actions(tmp_path):
    learner = make_learner(tiny_config(tmp_path, **DEVICE, epochs=1, target_kl=10.0))
    policy = learner.policy
    generator = torch.Generator().manual_seed(0)
    observations = torch.randn(400, len(learner.features), generator=generator)
    with torch.no_grad():
        distribution = policy.get_distribution(observations)
        actions = distribution.get_actions()
        log_probs = distribution.log_prob(actions)
        before = distribution.mode()
    advantages = actions[:, 0] - before[:, 0]
    update(policy, Steps(observations, actions, log_probs, advantages, advantages), learner.options)
    with torch.no_grad():
        after = policy.get_distribution(observations).mode()
    assert (after - before)[:, 0].mean() > 0.0


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"warm_start": "spsfa-tip"}, "imitates no controller.*'spsfa-tip'"),
        ({"reward": "paired"}, "device-ppo has no reward 'paired'"),
        ({"max_evaluations": 500}, "max_evaluations must be 0, got 500"),
        (
            {"also_on": ("fish-swarm",)},
            r"also_on \('fish-swarm',\) is for algorithm 'ppo' or 'evolution' only",
        ),
        ({"group_size": 2, "branch_at_events": True}, "branch_at_events True is for algorithm 'ppo' only"),
        ({"group_size": 3}, "multiple of group_size, got 4 and 3"),
        ({"device": "tpu"}, "device 'tpu'.*cuda"),
        ({"device": "cuda", "algorithm": "ppo"}, CUDA_IS_FOR + "'ppo'"),
        ({"device": "cuda", "algorithm": "recurrent-ppo"}, CUDA_IS_FOR + "'recurrent-ppo'"),
        ({"device": "cuda", **EVOLUTION}, CUDA_IS_FOR + "'evolution'"),
    ],
)
def test_what_this_algorithm_does_not_have_leaves_nothing_behind(tmp_path, options, message):
    with pytest.raises(ValueError, match=message):
        train(tmp_path, **{**DEVICE, **options})
    assert list(tmp_path.iterdir()) == []


def test_without_a_gpu_cuda_is_refused_in_one_line(tmp_path, monkeypatch):
    monkeypatch.setattr(torch.cuda, "is_available", lambda: False)
    with pytest.raises(ValueError, match=r"""^device ['"]cuda['"]: .*(no GPU here|numba-cuda)[^\n]*$"""):
        train(tmp_path, **DEVICE, device="cuda")
    assert list(tmp_path.iterdir()) == []

"""Episodes of all swarms, as tensors on one device, from groups that begin together to a rollout for PPO.

The vector environment either returns NumPy arrays, which torch takes without copying, or tensors on the
device. All swarms go through their iterations in step, so no number has to reach the host before an episode
has ended.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
import torch
from gymnasium.vector import VectorEnv
from stable_baselines3.common.policies import ActorCriticPolicy

from swarm_gym.runs.seeds import TRAINING_START, TRAINING_STOP
from swarm_gym.training.learners.device_base import TensorBase, TensorProposal, carried_out

Decide = Callable[[torch.Tensor], torch.Tensor]


class Rollout(NamedTuple):
    """One episode of B swarms, from the iteration at which they begin to differ, T steps.

    Attributes:
        observations: (T, B, n) observations of the policy, float32.
        actions: (T, B, k) outputs of the policy, with noise and not clipped.
        log_probs: (T, B) logarithms of the densities of the actions.
        values: (T, B) values of the critic; None without one.
        rewards: (T, B) rewards, float32; 0 where an episode has ended early.
        returns: (B,) sums of the rewards of whole episodes, common iterations included, float64.
        num_steps: environment steps that were computed; common iterations count once for a group.
    """

    observations: torch.Tensor
    actions: torch.Tensor
    log_probs: torch.Tensor
    values: torch.Tensor | None
    rewards: torch.Tensor
    returns: torch.Tensor
    num_steps: int


class DeviceSwarms:
    """Swarms in groups whose observations, actions and rewards are tensors on one device.

    A swarm whose episode ends early, such as one that arrives, rests until the last iteration: it has no
    rewards then, and its actions do nothing.

    Args:
        env: B swarms without autoreset.
        base: controller to whose decisions the actions are added, if any.
        group_size: number of swarms in a group, neighbours; they share seed, scenario and price.
        firsts: iterations, counted from 0, at which the swarms of a group begin to differ; one of them is
            drawn for all episodes that begin together.
        device: device of all tensors.

    Attributes:
        first: the iteration at which the episodes under way began to differ.
        iterations: length of an episode.
        returns: (B,) sums of the rewards of the episodes under way, float64.
    """

    def __init__(
        self,
        env: VectorEnv,
        base: TensorBase | None,
        group_size: int,
        firsts: tuple[int, ...],
        device: torch.device,
    ):
        self.device = device
        self.num_swarms = env.num_envs
        self._env = env
        swarms: Any = env.unwrapped
        self._swarms = swarms
        self._takes_tensors = False
        self._base = base
        self._proposal: TensorProposal | None = None
        episodes = np.arange(env.num_envs) // group_size
        self._episodes = episodes
        self._leaders = episodes * group_size  # the first swarm of each swarm's group
        self._firsts = firsts
        self.first = firsts[0]
        self.iterations: int = self._swarms.settings.iterations
        self.returns = torch.zeros(env.num_envs, dtype=torch.float64, device=device)

    def begin(self, generator: np.random.Generator, decide: Decide) -> tuple[torch.Tensor, int]:
        """Begin new episodes of all swarms.

        The first swarm of each group computes the iterations that the group has in common; the others then
        are copies of it.

        Args:
            generator: draws `first` and the seeds of the episodes.
            decide: function from the policy's observations to its actions in the common iterations.

        Returns:
            The policy's observations (B, n), and the number of environment steps that were computed.
        """
        self.first = self._firsts[generator.integers(len(self._firsts))]
        groups = int(self._episodes[-1]) + 1
        seed = int(generator.integers(TRAINING_START, TRAINING_STOP - groups))
        once = self._leaders == np.arange(self.num_swarms)
        seeds: Any = (seed + self._episodes).tolist()
        begun, _ = self._env.reset(seed=seeds, options={"reset_mask": once})
        self._takes_tensors = isinstance(begun, torch.Tensor)
        observations = self._taken(self._swarms.copy_swarms(self._leaders))
        if self._base is not None:
            self._base.reset(self.num_swarms)
        self.returns = torch.zeros_like(self.returns)
        leaders = torch.as_tensor(self._leaders, device=self.device)
        counted = torch.as_tensor(once, device=self.device)
        num_steps = torch.zeros((), dtype=torch.int64, device=self.device)
        ended = torch.zeros_like(counted)
        for _ in range(self.first):
            num_steps += (counted & ~ended).sum()
            actions = carried_out(decide(self._see(observations[leaders])), self._proposal)
            observations, rewards, ended = map(
                self._taken, self._swarms.step_running(self._given(actions), once)
            )
            self.returns += rewards
        if self.first:
            observations = self._taken(self._swarms.copy_swarms(self._leaders))
            self.returns = self.returns[leaders]
        return self._see(observations), int(num_steps)

    def step(self, decided: torch.Tensor) -> tuple[torch.Tensor, torch.Tensor]:
        """Advance all swarms by one iteration.

        Args:
            decided: (B, k) outputs of the policy: actions, or corrections of what the base has proposed.

        Returns:
            The policy's observations (B, n), float32, and rewards (B,).
        """
        actions = carried_out(decided, self._proposal)
        observations, rewards, _ = map(self._taken, self._swarms.step_running(self._given(actions)))
        self.returns += rewards
        return self._see(observations), rewards

    def _see(self, observations: torch.Tensor) -> torch.Tensor:
        """Return the policy's observations; the base proposes its decisions for this step."""
        if self._base is None:
            return observations.float()
        self._proposal = self._base.propose(observations)
        return self._proposal.seen

    def _taken(self, array: Any) -> torch.Tensor:
        return torch.as_tensor(array, device=self.device)

    def _given(self, actions: torch.Tensor) -> Any:
        """Return actions as the environment takes them, which is as it returns observations."""
        return actions if self._takes_tensors else actions.cpu().numpy()


@torch.no_grad()
def run_episode(
    policy: ActorCriticPolicy,
    swarms: DeviceSwarms,
    generator: np.random.Generator,
    *,
    critic: bool,
    noise_steps: int,
) -> Rollout:
    """Return one new episode of all swarms, in which the policy explores.

    Args:
        policy: policy of stable-baselines3 on the device of the swarms; with gSDE unless `noise_steps` is 1.
        swarms: the swarms.
        generator: draws the episodes; the noise comes from torch's generator.
        critic: whether to ask the critic for values.
        noise_steps: number of steps that share their noise; 0 is a whole episode.
    """
    policy.set_training_mode(False)
    seen, num_steps = swarms.begin(generator, lambda observed: policy.get_distribution(observed).mode())
    length = swarms.iterations - swarms.first

    # Steps are copied into tensors of the rollout, since an environment may reuse those that it returns.
    def column(*shape: int) -> torch.Tensor:
        return torch.empty(length, swarms.num_swarms, *shape, device=swarms.device)

    rollout = Rollout(
        column(seen.shape[1]),
        column(*(policy.action_space.shape or ())),
        column(),
        column() if critic else None,
        column(),
        swarms.returns,
        num_steps + length * swarms.num_swarms,
    )
    for step in range(length):
        if noise_steps != 1 and step % (noise_steps or length) == 0:
            policy.reset_noise(swarms.num_swarms)
        distribution = policy.get_distribution(seen)
        actions = distribution.get_actions()
        rollout.observations[step] = seen
        rollout.actions[step] = actions
        rollout.log_probs[step] = distribution.log_prob(actions)
        if rollout.values is not None:
            rollout.values[step] = policy.predict_values(seen).flatten()
        seen, rollout.rewards[step] = swarms.step(actions)
    return rollout

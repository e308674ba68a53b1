"""Double DQN with published settings, for lambda: `python -m experiments.onemax --train-double-dqn`.

Source: T. Nguyen, P. Le, C. Doerr, N. Dang, FOGA 2025, and the settings of github.com/taindp98/OneMax-MPDAC.
There is one training for each length. A network of two layers with 50 ReLU units sees n and f. It takes
200,000 steps: the first 10,000 at random, then 20 % of them at random. After each step it learns from a
minibatch of 2,048 by Adam; a target network follows by 1 %. The reward is gain - evaluations + shift. The
shift is minus a fifth of the absolute median of the first 10,000 rewards. Every 2,000 steps the greedy
policy is evaluated, and the best of these is kept. Here the exact expectation replaces the mean of runs.

All training seeds of a length learn side by side in stacked networks. There are few states, so a minibatch
comes as counts and sums: the gradient of a squared error needs only, for each state and choice, how often the
minibatch has it and the sum of its targets. Rounding aside, updates are those of a minibatch of transitions.
"""

import json
from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path

import numpy as np
import torch
from gymnasium.vector import AutoresetMode
from numpy.typing import NDArray
from tqdm import trange

from experiments.studies.onemax.q_policies import CHOICES, FILE, Policy, Trained, expected_of, stored
from swarm_gym.controllers.onemax_rules import OPTIMIZER
from swarm_gym.files import write_atomically
from swarm_gym.runs.provenance import provenance
from swarm_gym.vector_env import SwarmVectorEnv

SIZES = (100, 200, 500)
SEEDS = range(10)
STEPS, RANDOM_STEPS, EVALUATED_EVERY = 200_000, 10_000, 2_000
BATCH, UNITS, STEP_SIZE, EXPLORATION, FOLLOWING, DISCOUNT = 2048, 50, 1e-3, 0.2, 0.01, 0.9998
ITERATIONS = 6_000  # of an episode; a run that has not found the optimum by then begins again

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]


class ReplayMemory:
    """All transitions of S trainings that learn side by side.

    Args:
        seeds: training seeds, S of them, which decide what is drawn.
        num_states: number of states K that are not the optimum; the optimum is state K.
        capacity: most transitions of a training.
    """

    def __init__(self, seeds: Sequence[int], num_states: int, capacity: int):
        self._generators = [np.random.default_rng([num_states, seed]) for seed in seeds]
        self._cells = np.zeros((capacity, len(seeds)), dtype=np.int64)  # of states and choices
        self._after = np.zeros_like(self._cells)
        self._rewards = np.zeros(self._cells.shape)
        self._shape = len(seeds), num_states, len(CHOICES)
        self._filled = 0

    def add(self, states: Integers, choices: Integers, after: Integers, rewards: Floats) -> None:
        """Store one transition of each training, (S,) numbers of states and choices, and rewards."""
        num_seeds, num_states, num_choices = self._shape
        rows = np.arange(num_seeds)
        self._cells[self._filled] = (rows * num_states + states) * num_choices + choices
        self._after[self._filled] = rows * (num_states + 1) + after
        self._rewards[self._filled] = rewards
        self._filled += 1

    def median_rewards(self) -> Floats:
        """Return the (S,) medians of the rewards so far."""
        found: Floats = np.median(self._rewards[: self._filled], axis=0)
        return found

    def draw(self, values: Floats) -> tuple[Floats, Floats]:
        """Return a minibatch for each training, drawn with replacement, as counts and sums.

        Args:
            values: (S, K + 1) values of the next states; 0 at the optimum.

        Returns:
            (S, K, choices) numbers of transitions, and sums of their targets.
        """
        num_seeds = self._shape[0]
        drawn = [one.integers(self._filled, size=BATCH) * num_seeds for one in self._generators]
        places = (np.stack(drawn) + np.arange(num_seeds)[:, None]).ravel()
        targets = self._rewards.take(places) + DISCOUNT * values.take(self._after.take(places))
        cells, length = self._cells.take(places), int(np.prod(self._shape))
        counts = np.bincount(cells, minlength=length).astype(np.float64)
        sums: Floats = np.bincount(cells, weights=targets, minlength=length).astype(np.float64)
        return counts.reshape(self._shape), sums.reshape(self._shape)


class StackedNetworks(torch.nn.Module):
    """Networks of several training seeds side by side, each as PyTorch initialises it for its seed.

    Args:
        seeds: training seeds, S of them.
    """

    def __init__(self, seeds: Sequence[int]):
        super().__init__()
        widths = (2, UNITS, UNITS, len(CHOICES))
        layers = []
        for seed in seeds:
            torch.manual_seed(seed)
            layers.append([torch.nn.Linear(*pair) for pair in pairwise(widths)])
        by_layer = list(zip(*layers, strict=True))
        stack = torch.nn.ParameterList
        self.weights = stack(torch.stack([one.weight.detach().T for one in each]) for each in by_layer)
        self.biases = stack(torch.stack([one.bias.detach()[None] for one in each]) for each in by_layer)

    def forward(self, states: torch.Tensor) -> torch.Tensor:
        """Return the estimates, (S, K, choices), of states (S, K, 2)."""
        found = states
        for number, (weight, bias) in enumerate(zip(self.weights, self.biases, strict=True)):
            found = torch.baddbmm(bias, found, weight)
            if number < len(self.weights) - 1:
                found = torch.relu(found)
        return found


class Learners:
    """Double DQN of several training seeds that learn side by side from one memory.

    Args:
        size: n, the length of the string.
        seeds: training seeds, S of them.
    """

    def __init__(self, size: int, seeds: Sequence[int]):
        self.start, self.num_states = size // 2, size - size // 2
        self._networks, self._target = StackedNetworks(seeds), StackedNetworks(seeds)
        self._adam = torch.optim.Adam(self._networks.parameters(), lr=STEP_SIZE, fused=True)
        ones = torch.arange(self.start, size, dtype=torch.float32)
        states = torch.stack([torch.full_like(ones, float(size)), ones], dim=1)
        self._inputs = states.expand(len(seeds), -1, -1).contiguous()
        self.memory = ReplayMemory(seeds, self.num_states, STEPS)
        self._values = np.zeros((len(seeds), self.num_states + 1))
        self._estimates = self._networks(self._inputs)
        self.greedy = self._best()

    def _best(self) -> Integers:
        """Return (S, K) the choices of the highest estimates."""
        found: Integers = self._estimates.detach().argmax(dim=2).numpy()
        return found

    def learn(self) -> None:
        """Make one update by a minibatch for each seed, and let the target networks follow."""
        with torch.no_grad():
            of_target = self._target(self._inputs).numpy()
        self._values[:, :-1] = np.take_along_axis(of_target, self.greedy[..., None], axis=2)[..., 0]
        counts, sums = self.memory.draw(self._values)
        slope = 2.0 / BATCH * (counts * self._estimates.detach().numpy() - sums)
        self._adam.zero_grad()
        self._estimates.backward(torch.as_tensor(slope, dtype=torch.float32))
        self._adam.step()
        with torch.no_grad():
            for slow, fast in zip(self._target.parameters(), self._networks.parameters(), strict=True):
                slow.lerp_(fast, FOLLOWING)
        self._estimates = self._networks(self._inputs)
        self.greedy = self._best()


def train(size: int, seeds: Sequence[int], steps: int = STEPS) -> list[Policy]:
    """Train for strings of one length, and return the policies of the seeds.

    Args:
        size: n, the length of the string.
        seeds: training seeds, S of them.
        steps: environment steps of each training, at most `STEPS`.
    """
    torch.set_num_threads(1)
    learners, rows = Learners(size, seeds), np.arange(len(seeds))
    generators = [np.random.default_rng([size, seed]) for seed in seeds]
    shares = np.stack([one.random(steps) for one in generators], axis=1)
    others = np.stack([one.integers(len(CHOICES), size=steps) for one in generators], axis=1)
    explores = shares < np.where(np.arange(steps) < RANDOM_STEPS, 1.0, EXPLORATION)[:, None]
    swarms = SwarmVectorEnv(
        len(seeds),
        OPTIMIZER,
        scenario=f"onemax:{size}",
        autoreset_mode=AutoresetMode.DISABLED,
        iterations=ITERATIONS,
        max_population_size=int(CHOICES[-1]),
        num_threads=1,
    )
    seen, _ = swarms.reset(seed=list(map(int, seeds)))
    states = seen[:, 1].astype(np.int64) - learners.start
    found = [Policy(seed=int(seed), step=0, best=[], last=[]) for seed in seeds]
    least = np.full(len(seeds), np.inf)
    actions, shifts = np.zeros((len(seeds), 2)), np.zeros(len(seeds))
    for step in trange(steps, desc=f"n = {size}", mininterval=20.0):
        chosen = np.where(explores[step], others[step], learners.greedy[rows, states])
        actions[:, 0] = CHOICES[chosen]
        seen, paid, ended = swarms.step_running(actions)
        after = seen[:, 1].astype(np.int64) - learners.start
        learners.memory.add(states, chosen, after, after - states + np.rint(paid * size) + shifts)
        if ended.any():
            swarms.begin(ended, None, None)
        states = np.where(ended, 0, after)
        if step + 1 == RANDOM_STEPS:
            shifts = -np.abs(learners.memory.median_rewards()) / 5.0
        if step >= RANDOM_STEPS:
            learners.learn()
            if (step + 1) % EVALUATED_EVERY == 0:
                for row, policy in enumerate(learners.greedy.tolist()):
                    found[row]["last"] = policy
                    evaluations = expected_of(policy, size)
                    if evaluations < least[row]:
                        least[row] = evaluations
                        found[row]["best"], found[row]["step"] = policy, step + 1
    return found


def ship(sizes: Sequence[int] = SIZES, seeds: Sequence[int] = SEEDS, file: Path = FILE) -> Path:
    """Train for the lengths, one after the other, and store the policies in the file, which is returned.

    Args:
        sizes: lengths to train for; other lengths in the file stay.
        seeds: training seeds.
        file: file of the policies.
    """
    for size in sizes:
        trained = Trained(policies=train(size, seeds), provenance=provenance())
        by_size = {**stored(file), str(size): trained}
        write_atomically(file, json.dumps(by_size, separators=(",", ":")) + "\n")
    return file

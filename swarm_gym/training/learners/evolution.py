"""Evolution strategies on the weights of the actor.

Sources: N. Hansen, "The CMA evolution strategy: a tutorial", arXiv 1604.00772 (2016); for many weights its
separable form, R. Ros and N. Hansen, PPSN X (2008); T. Salimans et al., "Evolution strategies as a scalable
alternative to reinforcement learning", arXiv 1703.03864 (2017). The objective is the mean return of a policy
without noise in its actions, as it is used later.
"""

from collections.abc import Iterator, Mapping, Sequence
from itertools import pairwise
from typing import Any

import numpy as np
import torch
from cmaes import CMA, SepCMA
from gymnasium.vector import AutoresetMode, VectorEnv
from numpy.typing import NDArray

from swarm_gym.controllers.learned.networks import affine, tanh_of_layer
from swarm_gym.controllers.learned.policy_file import Weights
from swarm_gym.controllers.learned.residual import Base, carried_out
from swarm_gym.runs.checkpoints import load_strategy, strategy_state
from swarm_gym.training.algorithms import Evolution
from swarm_gym.training.config import ENV_REWARD, PAIRED, TrainConfig
from swarm_gym.training.learners.environments import feature_names, make_swarms, parts_of
from swarm_gym.training.learners.learner import Learner
from swarm_gym.wrappers.beginnings import begin_together

Floats = NDArray[np.float64]
# Weights and biases of a layer of all candidates, as in policy files.
Layer = tuple[NDArray[np.float32], NDArray[np.float32]]

MOST_WEIGHTS_WITH_COVARIANCE = 200


class EvolutionLearner(Learner):
    """CMA-ES on the weights of an actor; all candidates of a generation have the same episodes.

    With several optimizers, each has the same number of swarms, and a return is the mean over them.
    """

    def __init__(self, config: TrainConfig, options: Evolution):
        super().__init__()
        self.config, self.options = config, options
        self._earned: list[list[float]] = []  # largest and mean return of each generation of the chunk so far
        together = options.candidates * len(config.optimizers)
        if config.num_swarms % together:
            times = f" times {len(config.optimizers)} optimizers" if config.algorithm.also_on else ""
            raise ValueError(
                f"num_swarms must be a multiple of candidates{times}, got {config.num_swarms} and "
                f"{options.candidates}"
            )
        if config.reward == PAIRED:
            raise ValueError(
                "evolution: all candidates have the same starts, so a paired reward changes nothing; "
                f"use reward {ENV_REWARD!r}"
            )
        self.num_steps = 0
        # The swarms of each optimizer, and the base that the policy corrects.
        self._parts = [
            make_swarms(part, part.num_swarms, AutoresetMode.DISABLED) for part in parts_of(config)
        ]
        env, base = self._parts[0]
        self.features = feature_names(config, base)
        self.num_decisions = int(np.prod(env.single_action_space.shape or ()))
        sizes = (len(self.features), *config.hidden_layers, self.num_decisions)
        self._shapes = [(into, out) for into, out in pairwise(sizes)]
        begin = self._first_weights(np.random.default_rng(config.seed))
        strategy = CMA if len(begin) <= MOST_WEIGHTS_WITH_COVARIANCE else SepCMA
        self._strategy = strategy(
            mean=begin, sigma=options.sigma, seed=config.seed, population_size=options.candidates
        )

    @property
    def in_chunk(self) -> bool:
        """True if some generations of the chunk are done."""
        return bool(self._earned)

    def begin(self) -> None:
        """Do nothing: the last layer is zero at first, so that a policy with a base decides as its base."""

    def learn(self, seed: int) -> dict[str, float]:
        """Run `rollouts_per_chunk` generations; return means of their returns, and the step size."""
        for generation in range(len(self._earned), self.config.rollouts_per_chunk):
            candidates = np.stack([self._strategy.ask() for _ in range(self.options.candidates)])
            earned = self._earn(candidates, seed + generation * self.config.num_swarms)
            self._strategy.tell(list(zip(candidates, -earned, strict=True)))
            self._earned.append([float(earned.max()), float(earned.mean())])
            self.after_rollout()
        largest, mean = np.mean(self._earned, axis=0)
        self._earned = []
        return {
            "evolution/best return": float(largest),
            "evolution/mean return": float(mean),
            "evolution/sigma": float(self._strategy._sigma),
        }

    def weights(self) -> Weights:
        """Return the mean of the search distribution."""
        weights = {}
        for number, layer in enumerate(self._layers(self._strategy.mean[None])):
            weight, bias = _rounded(*layer)
            weights[f"{number}.weight"], weights[f"{number}.bias"] = weight[0], bias[0]
        return weights

    def state(self) -> dict[str, object]:
        """Return the numbers of the strategy and of its random generator."""
        arrays = strategy_state(self._strategy)
        # Checkpoints are read without running code, and so have tensors instead of NumPy arrays.
        tensors = {name: torch.as_tensor(array) for name, array in arrays.items()}
        return {"num_steps": self.num_steps, "strategy": tensors, "earned": list(self._earned)}

    def load(self, state: Mapping[str, object]) -> None:
        """Continue from a state."""
        stored: Any = state
        self.num_steps = stored["num_steps"]
        self._earned = list(stored.get("earned", []))
        arrays = {name: tensor.numpy().copy() for name, tensor in stored["strategy"].items()}
        load_strategy(self._strategy, arrays)

    def _earn(self, candidates: Floats, seed: int) -> Floats:
        """Return the (n,) mean returns of n candidates (n, number of weights), each on the same episodes."""
        layers = [_rounded(*layer) for layer in self._layers(candidates)]
        return np.mean([self._earn_with(env, base, layers, seed) for env, base in self._parts], axis=0)

    def _earn_with(self, env: VectorEnv, base: Base | None, layers: Sequence[Layer], seed: int) -> Floats:
        """Return the (n,) mean returns of n candidates, given by their layers, with one optimizer."""
        num_candidates = len(layers[0][0])
        episodes = env.num_envs // num_candidates
        swarms: Any = env.unwrapped
        rows = np.tile(np.arange(episodes), num_candidates)
        # In the first iterations, which all candidates share, the base decides alone.
        observations, returns, ended, num_steps = begin_together(
            env, base, rows, seed, self.config.corrected_from
        )
        self.num_steps += num_steps
        while not ended.all():
            proposal = None
            if base is not None:
                proposal = base.propose(observations)
                observations = proposal.seen
            hidden = observations.astype(np.float32).reshape(num_candidates, episodes, -1)
            for number, (weight, bias) in enumerate(layers):
                hidden = affine(hidden, weight[:, None], bias[:, None])
                if number < len(layers) - 1:
                    hidden = tanh_of_layer(hidden)
            actions = carried_out(hidden.reshape(env.num_envs, -1), proposal)
            self.num_steps += int((~ended).sum())
            observations, rewards, ended = swarms.step_running(actions)
            returns += rewards
        return returns.reshape(num_candidates, episodes).mean(axis=1)

    def _layers(self, candidates: Floats) -> Iterator[tuple[Floats, Floats]]:
        """Yield weights (n, inputs, outputs) and biases (n, outputs) of every layer, as views."""
        place = 0
        for into, out in self._shapes:
            weight = candidates[:, place : place + into * out].reshape(-1, into, out)
            place += into * out
            yield weight, candidates[:, place : place + out]
            place += out

    def _first_weights(self, generator: np.random.Generator) -> Floats:
        """Draw the weights of hidden layers; the last layer has zeros."""
        parts = []
        for number, (into, out) in enumerate(self._shapes):
            scale = 0.0 if number == len(self._shapes) - 1 else 1.0 / np.sqrt(into)
            parts += [scale * generator.standard_normal(into * out), np.zeros(out)]
        return np.concatenate(parts)


def _rounded(weight: Floats, bias: Floats) -> Layer:
    """Return a layer as in policy files: (n, outputs, inputs) and (n, outputs), float32."""
    return np.ascontiguousarray(weight.transpose(0, 2, 1), dtype=np.float32), bias.astype(np.float32)

"""A controller trained by PPO: the actor network's forward pass in NumPy."""

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from agents.controller import Floats, SizeLimits
from agents.policy_file import PolicyFileError, load_policy, resolve
from swarm_gym.action import ACTIONS, make_action
from swarm_gym.observation import OBSERVATIONS
from swarm_gym.settings import Settings


class PPOController:
    """Deterministic actions (the mean of the policy) of a trained actor.

    Sums run along one row at a time, so that a decision does not depend on how many swarms are decided
    for at once; and no torch is needed.

    Attributes:
        manifest: what is known of the policy: layouts, configuration, seeds, versions.
    """

    def __init__(self, policy: str | Path, limits: SizeLimits = SizeLimits()):  # noqa: B008
        path = resolve(str(policy))
        weights, self.manifest = load_policy(path)
        self._check_layouts(path, limits)
        self.observation: str = self.manifest["observation"]
        self.initial_population_size: int = self.manifest["initial_population_size"]
        self._layers = _layers(path, weights, self.manifest)
        settings = Settings(
            action=self.manifest["action"],
            min_population_size=limits.smallest,
            max_population_size=limits.largest,
            initial_population_size=self.initial_population_size,
        )
        self._action = make_action(settings)

    def reset(self, num_swarms: int, seed: int = 0) -> None:
        """Nothing to begin: the policy has no memory and takes no chances."""

    def act(self, observations: NDArray) -> Floats:
        """Population sizes (not yet rounded) and phi of each swarm."""
        hidden = np.asarray(observations, dtype=np.float32)
        for weight, bias in self._layers[:-1]:
            hidden = np.tanh(_affine(hidden, weight, bias))
        means = _affine(hidden, *self._layers[-1])
        actions = np.clip(means, self._action.space.low, self._action.space.high)
        sizes, repair_degrees = self._action.decode(actions, np.ones(len(actions), dtype=np.bool_))
        return np.stack([sizes.astype(np.float64), repair_degrees], axis=1)

    def _check_layouts(self, path: Path, limits: SizeLimits) -> None:
        manifest = self.manifest
        for kind, registry in (("observation", OBSERVATIONS), ("action", ACTIONS)):
            if manifest[kind] not in registry:
                raise PolicyFileError(
                    f"{path}: {kind} layout {manifest[kind]!r} is not one of {sorted(registry)}"
                )
        features = [feature.name for feature in OBSERVATIONS[manifest["observation"]].features]
        if manifest["features"] != features:
            raise PolicyFileError(
                f"{path}: trained with observation features {manifest['features']}, "
                f"but {manifest['observation']!r} has {features}"
            )
        trained = SizeLimits(manifest["min_population_size"], manifest["max_population_size"])
        if trained != limits:
            raise PolicyFileError(f"{path}: trained for population sizes {trained}, asked for {limits}")


def _affine(values: NDArray, weight: NDArray, bias: NDArray) -> NDArray:
    return (values[:, None, :] * weight[None]).sum(axis=-1, dtype=np.float64).astype(np.float32) + bias


def _layers(
    path: Path, weights: dict[str, NDArray], manifest: dict[str, Any]
) -> list[tuple[NDArray, NDArray]]:
    """Weights and biases by layer, held against the shapes that the manifest implies."""
    sizes = [len(manifest["features"]), *manifest["hidden_layers"], 2]
    layers = []
    for number, shape in enumerate(zip(sizes[1:], sizes, strict=False)):
        try:
            weight, bias = weights[f"{number}.weight"], weights[f"{number}.bias"]
        except KeyError as error:
            raise PolicyFileError(f"{path}: tensor {error} is missing") from error
        if weight.shape != shape or bias.shape != shape[:1]:
            raise PolicyFileError(
                f"{path}: layer {number} has shapes {weight.shape} and {bias.shape}, expected {shape}"
            )
        layers.append((weight, bias))
    return layers

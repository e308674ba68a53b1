"""A learned controller: the forward pass of a feedforward actor in NumPy."""

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from agents.controller import Controller, SizeLimits
from agents.policy_file import PolicyFileError, Weights
from agents.residual import Base, carried_out
from swarm_gym.action import ACTIONS, make_action
from swarm_gym.checks import look_up
from swarm_gym.errors import UnknownNameError
from swarm_gym.observation import make_observation
from swarm_gym.optimizers import get_optimizer
from swarm_gym.settings import Settings


class FeedforwardController(Controller):
    """Deterministic actions (the mean of the policy) of a trained actor.

    Sums run along one row at a time, so that a decision does not depend on how many swarms are decided
    for at once; and no torch is needed.

    Args:
        path: the file, for messages; see `agents.learned.load_learned`.
        weights: what the file holds.
        manifest: what it says of them.
        limits: the sizes that the environment allows.
        price: what evaluations cost, for a policy that sees it.

    Attributes:
        manifest: what is known of the policy: layouts, configuration, seeds, versions.
        network: the kind of network, as the manifest names it.

    Raises:
        PolicyFileError: if weights and manifest do not fit together, or the policy is for something else.
    """

    network = "feedforward"

    def __init__(
        self, path: Path, weights: Weights, manifest: dict[str, Any], limits: SizeLimits, price: float | None
    ):
        self.manifest = manifest
        self._check_layouts(path, limits)
        self.price = self._checked_price(path, price)
        self.observation = self.manifest["observation"]
        self.action = self.manifest["action"]
        self.initial_population_size = self.manifest["initial_population_size"]
        self.max_evaluations = self.manifest.get("max_evaluations")
        self._base = self._make_base(path, limits)
        self._read_weights(path, weights)

    def reset(self, num_swarms: int, seed: int = 0) -> None:
        """The policy itself has no memory and takes no chances; the controller that it corrects may."""
        if self._base is not None:
            self._base.controller.reset(num_swarms, seed)

    def act(self, observations: NDArray) -> NDArray:
        """Actions of each swarm, in the layout that the policy was trained with."""
        proposal = None
        if self._base is not None:
            proposal = self._base.propose(observations)
            observations = proposal.seen
        hidden = self._features(np.asarray(observations, dtype=np.float32))
        for weight, bias in self._layers[:-1]:
            hidden = np.tanh(affine(hidden, weight, bias))
        return carried_out(affine(hidden, *self._layers[-1]), proposal)

    def _read_weights(self, path: Path, weights: Weights) -> None:
        """Keep the weights, held against the shapes that the manifest implies."""
        self._layers = read_layers(path, weights, self.manifest, len(self.manifest["features"]))

    def _features(self, seen: NDArray) -> NDArray:
        """What the first layer gets, of what the policy sees, (B, number of features) float32."""
        return seen

    def _checked_price(self, path: Path, price: float | None) -> float | None:
        """The price that is shown to the policy; without one, the middle of those it was trained with."""
        if "priced" not in self.manifest["observation"].split("+"):
            if price is not None:
                raise PolicyFileError(f"{path}: this policy does not see a price, got {price:g}")
            return None
        low, high = self.manifest["price"][0], self.manifest["price"][-1]
        if price is None:
            return float(np.sqrt(low * high))
        if not low <= price <= high:
            raise PolicyFileError(f"{path}: trained with prices in [{low:g}, {high:g}], got {price:g}")
        return price

    def _make_base(self, path: Path, limits: SizeLimits) -> Base | None:
        name = self.manifest["base"]
        if name == "none":
            return None
        from agents import make_controller

        settings = Settings(
            action=self.action,
            min_population_size=limits.smallest,
            max_population_size=limits.largest,
            initial_population_size=limits.smallest,
            max_evaluations=self.max_evaluations,
        )
        layout = make_action(settings, get_optimizer(self.manifest["optimizer"]))
        corrected_from = self.manifest.get("corrected_from", 0)
        try:
            base = Base(make_controller(name, limits), layout, corrected_from, self.max_evaluations)
        except ValueError as error:
            raise PolicyFileError(f"{path}: base {name!r}: {error}") from error
        self.corrects = base.controller
        self.observation = f"{self.corrects.observation}+{self.observation}"
        return base

    def _check_layouts(self, path: Path, limits: SizeLimits) -> None:
        manifest = self.manifest
        try:
            look_up("action layout", manifest["action"], ACTIONS)
            layout = make_observation(manifest["observation"])
        except UnknownNameError as error:
            raise PolicyFileError(f"{path}: {error}") from error
        features = [feature.name for feature in layout.features]
        if manifest["features"][: len(features)] != features:
            raise PolicyFileError(
                f"{path}: trained with observation features {manifest['features']}, "
                f"but {manifest['observation']!r} has {features}"
            )
        trained = SizeLimits(manifest["min_population_size"], manifest["max_population_size"])
        if trained != limits:
            raise PolicyFileError(f"{path}: trained for population sizes {trained}, asked for {limits}")


def affine(values: NDArray, weight: NDArray, bias: NDArray) -> NDArray:
    """(..., outputs) of values (..., inputs), weight (..., outputs, inputs) and bias (..., outputs), float32.

    Each sum is made alone, in float64, so that it is the same in any company.
    """
    return (values[..., None, :] * weight).sum(axis=-1, dtype=np.float64).astype(np.float32) + bias


def read_layers(
    path: Path, weights: Weights, manifest: dict[str, Any], inputs: int
) -> list[tuple[NDArray, NDArray]]:
    """Weights and biases by layer, the first of this many inputs, held against the manifest.

    Raises:
        PolicyFileError: if a tensor is missing or has another shape.
    """
    sizes = [inputs, *manifest["hidden_layers"], manifest["num_decisions"]]
    layers = []
    for number, shape in enumerate(zip(sizes[1:], sizes, strict=False)):
        layers.append(read_layer(path, weights, number, shape))
    return layers


def read_layer(
    path: Path, weights: Weights, name: int | str, shape: tuple[int, int]
) -> tuple[NDArray, NDArray]:
    """Weight and bias of one layer, of shape (outputs, inputs).

    Raises:
        PolicyFileError: if a tensor is missing or has another shape.
    """
    try:
        weight, bias = weights[f"{name}.weight"], weights[f"{name}.bias"]
    except KeyError as error:
        raise PolicyFileError(f"{path}: tensor {error} is missing") from error
    if weight.shape != shape or bias.shape != shape[:1]:
        raise PolicyFileError(
            f"{path}: layer {name} has shapes {weight.shape} and {bias.shape}, expected {shape}"
        )
    return weight, bias

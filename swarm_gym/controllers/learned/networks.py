"""Learned controllers: forward passes of trained actors in NumPy, without torch.

A policy's manifest names its kind of network, a key of `NETWORKS`. Sums run along one row at a time, so that
a decision does not depend on how many swarms are decided for at once.
"""

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Self

import numpy as np
from numpy.typing import NDArray

from swarm_gym.action import Action, make_action
from swarm_gym.compiler.elementary import tanh
from swarm_gym.controllers.controller import Controller, SizeLimits
from swarm_gym.controllers.learned.manifest import (
    CHOICES,
    FEEDFORWARD,
    LSTM,
    Manifest,
    PolicyFileError,
    observes_price,
    require_features,
)
from swarm_gym.controllers.learned.policy_file import Weights
from swarm_gym.controllers.learned.residual import Base, carried_out
from swarm_gym.errors import SettingError
from swarm_gym.observation import ITERATION
from swarm_gym.optimizers import get_optimizer
from swarm_gym.settings import Settings
from swarm_gym.sources import Source

# Entries of a manifest on which decisions depend.
_DECISIVE = (
    "weights_sha256",
    "network",
    "optimizer",
    "observation",
    "action",
    "initial_population_size",
    "min_population_size",
    "max_population_size",
    "max_evaluations",
    "corrected_from",
)
MakeController = Callable[[str, SizeLimits], Controller]


class FeedforwardController(Controller):
    """The mean actions of a trained feedforward actor.

    Args:
        path: file of the policy, for messages.
        weights: tensors of the file, as `policy_file.load_policy` checked them.
        manifest: manifest of the file.
        limits: population sizes that the environment allows; None takes the sizes of the training.
        price: price of 100,000 evaluations, for a policy that observes it; None is the middle of the
            training's range.
        make_controller: function that makes the base, for a policy that corrects another controller.

    Attributes:
        manifest: layouts, configuration, seeds and versions of the policy.
        network: kind of network, as the manifest names it.

    Raises:
        PolicyFileError: if the policy was made for something else.
    """

    network = FEEDFORWARD

    def __init__(
        self,
        path: Path,
        weights: Weights,
        manifest: Manifest,
        limits: SizeLimits | None,
        price: float | None,
        make_controller: MakeController,
    ):
        self.manifest = manifest
        trained = SizeLimits(manifest["min_population_size"], manifest["max_population_size"])
        if limits is not None and limits != trained:
            raise PolicyFileError(f"{path}: trained for population sizes {trained}, asked for {limits}")
        self.needed_limits = limits = trained
        self.price = self._checked_price(path, price)
        self.observation = self.manifest["observation"]
        self.action = self.manifest["action"]
        self.made_for = None if self.manifest.get("also_on") else self.manifest["optimizer"]
        self.initial_population_size = self.manifest["initial_population_size"]
        self.first_source = _source_of(path, self.manifest.get("first_source"))
        self.max_evaluations = self.manifest["max_evaluations"]
        self._base = self._make_base(path, self._make_layout(path, limits), limits, make_controller)
        self._read_weights(weights)

    def reset(self, num_swarms: int, seed: int = 0) -> None:
        """Reset the controller that the policy corrects; the policy itself has no state."""
        if self._base is not None:
            self._base.controller.reset(num_swarms, seed)

    def stretched(self, factor: float) -> Self:
        """Return the policy with a base that is stretched; what it observes of the iteration is a share.

        Args:
            factor: number of iterations of an episode, relative to the one of its training.
        """
        other = super().stretched(factor)
        if self._base is not None:
            other._base = self._base.stretched(factor)
            other.corrects = other._base.controller
        return other

    def identity(self) -> object:
        """Return the digest of the weights, the layouts and sizes, and the controller that is corrected.

        The rest of the manifest says where the policy comes from.
        """
        manifest: Mapping[str, object] = self.manifest
        said = {name: manifest[name] for name in _DECISIVE}
        corrected = self.corrects.identity() if self.corrects else None
        return "learned", said, self.manifest.get("first_source"), self.price, corrected

    def act(self, observations: NDArray) -> NDArray:
        """Return (B, k) actions in the layout that the policy was trained with."""
        proposal = None
        if self._base is not None:
            proposal = self._base.propose(observations)
            observations = proposal.seen
        hidden = self._features(np.asarray(observations, dtype=np.float32))
        for weight, bias in self._layers[:-1]:
            hidden = tanh_of_layer(affine(hidden, weight, bias))
        return carried_out(self._decided(affine(hidden, *self._layers[-1])), proposal)

    def _read_weights(self, weights: Weights) -> None:
        """Keep the weights, layer by layer."""
        numbers = range(len(self.manifest["hidden_layers"]) + 1)
        self._layers = [(weights[f"{number}.weight"], weights[f"{number}.bias"]) for number in numbers]

    def _features(self, seen: NDArray) -> NDArray:
        """Return the input of the first layer, given the policy's observations (B, features) in float32."""
        return seen

    def _decided(self, outputs: NDArray) -> NDArray:
        """Return the decisions (B, k), given the outputs of the last layer."""
        return outputs

    def _checked_price(self, path: Path, price: float | None) -> float | None:
        """Return the price that the policy observes; by default the middle of its training's range."""
        if not observes_price(self.manifest):
            if price is not None:
                raise PolicyFileError(
                    f"{path}: this policy does not observe a price, got {price:g}; leave out @{price:g}"
                )
            return None
        prices = self.manifest["price"] or []  # which are checked
        low, high = prices[0], prices[-1]
        if price is None:
            return float(np.sqrt(low * high))
        if not low <= price <= high:
            raise PolicyFileError(f"{path}: trained with prices in [{low:g}, {high:g}], got {price:g}")
        return price

    def _make_layout(self, path: Path, limits: SizeLimits) -> Action:
        """Return the action layout; the last layer must have one output for each of its decisions."""
        settings = Settings(
            action=self.action,
            min_population_size=limits.smallest,
            max_population_size=limits.largest,
            initial_population_size=limits.smallest,
            max_evaluations=self.max_evaluations,
        )
        try:
            layout = make_action(settings, get_optimizer(self.manifest["optimizer"]))
        except SettingError as error:
            raise PolicyFileError(f"{path}: {error}") from error
        if len(layout.labels) != self.manifest["num_decisions"]:
            raise PolicyFileError(
                f"{path}: num_decisions must be {len(layout.labels)} with action {self.action!r} "
                f"({', '.join(layout.labels)}), got {self.manifest['num_decisions']}"
            )
        return layout

    def _make_base(
        self, path: Path, layout: Action, limits: SizeLimits, make_controller: MakeController
    ) -> Base | None:
        name = self.manifest["base"]
        if name == "none":
            return None
        try:
            controller = make_controller(name, limits)
            base = Base(controller, layout, self.manifest["corrected_from"], self.max_evaluations)
        except ValueError as error:
            raise PolicyFileError(f"{path}: base {name!r}: {error}") from error
        require_features(path, self.manifest, base.features(self.observation))
        self.corrects = base.controller
        self.observation = f"{self.corrects.observation}+{self.observation}"
        return base


def _source_of(path: Path, numbers: object) -> Source | None:
    """Return the source of the first population; None is the environment's own."""
    try:
        return None if numbers is None else Source.of(numbers)
    except SettingError as error:
        raise PolicyFileError(f"{path}: {error}") from error


class RecurrentController(FeedforwardController):
    """The mean actions of an actor with an LSTM before its layers; an episode begins with an empty memory.

    Source: S. Hochreiter, J. Schmidhuber, "Long short-term memory", Neural Computation 9 (1997), with the
    forget gate of F. Gers et al., Neural Computation 12 (2000); gates in the order of `torch.nn.LSTM`. The
    four numbers of the SPSFA paper lack the population size; a memory can make up for missing observations.

    The file has a layer `lstm` with weight (4 h, features + h) and bias (4 h,), and the layers after it. The
    manifest's `lstm_size` is h.
    """

    network = LSTM

    def reset(self, num_swarms: int, seed: int = 0) -> None:
        """Empty the memory."""
        super().reset(num_swarms, seed)
        self._hidden = np.zeros((num_swarms, self._size), dtype=np.float32)
        self._cell = np.zeros((num_swarms, self._size), dtype=np.float32)

    def _read_weights(self, weights: Weights) -> None:
        super()._read_weights(weights)
        self._size = self.manifest["lstm_size"] or 0  # which is checked
        self._lstm = weights["lstm.weight"], weights["lstm.bias"]

    def _features(self, seen: NDArray) -> NDArray:
        """Return the hidden state (B, h) after these observations."""
        goes_on = (seen[:, ITERATION] != 0).astype(np.float32)[:, None]
        hidden, cell = goes_on * self._hidden, goes_on * self._cell
        gates = affine(np.concatenate([seen, hidden], axis=1), *self._lstm)
        keep_new, keep_old, new, show = np.split(gates, 4, axis=1)  # i, f, g, o
        self._cell = _sigmoid(keep_old) * cell + _sigmoid(keep_new) * tanh_of_layer(new)
        self._hidden = _sigmoid(show) * tanh_of_layer(self._cell)
        return self._hidden


class ChoiceController(FeedforwardController):
    """The action, of several, whose return a trained network estimates to be the largest.

    The file has a tensor `choices` of actions, (n, k), where n is the manifest's `num_choices`. The last
    layer has an output for each of them. Of equal estimates the first one counts.
    """

    network = CHOICES

    def _read_weights(self, weights: Weights) -> None:
        super()._read_weights(weights)
        self._choices = weights["choices"]

    def _decided(self, outputs: NDArray) -> NDArray:
        return self._choices[outputs.argmax(axis=1)]


NETWORKS: dict[str, type[FeedforwardController]] = {
    network.network: network for network in (FeedforwardController, RecurrentController, ChoiceController)
}


def affine(values: NDArray, weight: NDArray, bias: NDArray) -> NDArray:
    """Return (..., outputs) = weight (..., outputs, inputs) times values (..., inputs) plus bias, in float32.

    Each sum is computed by itself in float64, so that it does not depend on the other rows.
    """
    return (values[..., None, :] * weight).sum(axis=-1, dtype=np.float64).astype(np.float32) + bias


def tanh_of_layer(values: NDArray) -> NDArray:
    """Return the hyperbolic tangent, computed in float64 and rounded to float32."""
    return tanh(values).astype(np.float32)


def _sigmoid(values: NDArray) -> NDArray:
    return np.float32(0.5) + np.float32(0.5) * tanh_of_layer(np.float32(0.5) * values)

"""Open loops tuned by CMA-ES.

Source: N. Hansen, "The CMA evolution strategy: a tutorial", arXiv 1604.00772 (2016). The candidates of a
generation have the same episodes, and every generation has new ones. The result is the mean of the search
distribution, since the best sample of a noisy function owes its rank to luck.
"""

import io
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from cmaes import CMA
from numpy.typing import NDArray

from swarm_gym.checks import require_integer, require_number
from swarm_gym.controllers.controller import Controller
from swarm_gym.controllers.open_loop import save_open_loop
from swarm_gym.controllers.reacting_loop import ReactingLoop
from swarm_gym.runs.checkpoints import Checkpoints, load_strategy, strategy_state
from swarm_gym.runs.seeds import training_seed
from swarm_gym.tuning.config import TuneConfig, Tuner
from swarm_gym.tuning.knots import KnotSpace
from swarm_gym.tuning.side_by_side import SideBySide


class OpenLoopTuner(Tuner):
    """CMA-ES on the decisions at the knots; a round is a generation."""

    family = "open-loop"

    def __init__(self, config: TuneConfig):
        require_integer("candidates", config.candidates, 4)
        require_number("sigma", config.sigma, 1e-6, 1.0)
        self._config = config
        self._space = KnotSpace(config)
        start = self._space.start
        bounds = np.tile([0.0, 1.0], (len(start), 1))
        self._strategy = CMA(
            mean=start,
            sigma=config.sigma,
            bounds=bounds,
            seed=config.seed,
            population_size=config.candidates,
        )
        first = self.result()
        self._places = SideBySide(config, config.candidates, first.observation, first.action)
        self.steps_per_round = self._places.steps
        self._points = np.empty((0, config.candidates, len(start)))
        self._losses = np.empty((0, config.candidates))

    def open(self, folder: Path) -> None:
        """Load the last checkpoint, if there is one."""
        self._checkpoints = Checkpoints(folder, ".npz")
        state = self._checkpoints.load(_arrays)
        if state is None:
            return
        self._points, self._losses = state.pop("points"), state.pop("losses")
        load_strategy(self._strategy, state)
        self.rounds = len(self._losses)

    def advance(self) -> dict[str, float]:
        """Run one generation."""
        points = np.stack([self._strategy.ask() for _ in range(self._config.candidates)])
        controllers = [self._controller(point) for point in points]
        outcomes = self._places.run(controllers, training_seed(self._config.seed, self.rounds))
        losses = outcomes.losses.mean(axis=1)
        self._strategy.tell(list(zip(points, losses.tolist(), strict=True)))
        self._points = np.concatenate([self._points, points[None]])
        self._losses = np.concatenate([self._losses, losses[None]])
        self.rounds += 1
        content = io.BytesIO()
        state: dict[str, Any] = {"points": self._points, "losses": self._losses}
        state |= strategy_state(self._strategy)
        np.savez_compressed(content, **state)
        self._checkpoints.save(content.getvalue())
        return {"best": losses.min(), "mean": losses.mean(), "sigma": float(self._strategy._sigma)}

    def seeds(self) -> list[int]:
        """Return the first seed of every generation; each has new episodes."""
        return [training_seed(self._config.seed, generation) for generation in range(self.rounds)]

    def result(self) -> Controller:
        """Return the controller of the mean of the search distribution."""
        return self._controller(self._strategy.mean)

    def _controller(self, point: NDArray) -> Controller:
        return self._space.controller(point)

    def write(self, path: Path, manifest: Mapping[str, object]) -> None:
        """Write the open loop that `open-loop:<path>` reads."""
        save_open_loop(path, self._space.decode(self._strategy.mean), manifest)


class ReactingLoopTuner(OpenLoopTuner):
    """CMA-ES on the decisions at the knots of an open loop that begins again when the best fitness rises."""

    family = "reacting-loop"

    def _controller(self, point: NDArray) -> Controller:
        return ReactingLoop(self._space.controller(point))


def _arrays(content: bytes) -> dict[str, Any]:
    """Return the arrays of a checkpoint by name."""
    with np.load(io.BytesIO(content), allow_pickle=False) as stored:
        return {name: stored[name] for name in stored.files}

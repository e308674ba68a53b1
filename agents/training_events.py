"""What TensorBoard shows of a training run: scalars, pictures of each validation, hyperparameters."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from torch.utils.tensorboard import SummaryWriter
from torch.utils.tensorboard.summary import hparams

from agents.rollout import Episodes
from agents.training_figures import draw_decisions


class TrainingEvents:
    """The events of a run, in its folder; a run that goes on adds to them.

    Args:
        folder: of the run.
    """

    def __init__(self, folder: Path):
        self._writer = SummaryWriter(str(folder))

    def add_scalars(self, scalars: Mapping[str, float], step: int) -> None:
        """Add numbers by name."""
        for name, value in scalars.items():
            self._writer.add_scalar(name, value, step)

    def add_decisions(self, by_scenario: Mapping[str, Episodes], step: int) -> None:
        """Add size and phi against the iteration, and their means at every tenth as scalars."""
        self._add_picture("validation/decisions", draw_decisions(by_scenario), step)
        for name in ("sizes", "repair_degrees"):
            values = np.concatenate([getattr(episodes, name) for episodes in by_scenario.values()])
            for iteration in range(0, values.shape[1], 10):
                column = values[:, iteration]
                if np.isnan(column).all():
                    break  # a budget has ended all episodes before
                self._writer.add_scalar(f"{name}/iteration {iteration + 1:03}", np.nanmean(column), step)

    def add_replay(self, picture: NDArray[np.uint8], step: int) -> None:
        """Add an episode as a strip of pictures, shape (height, width, 3)."""
        self._add_picture("validation/replay", picture, step)

    def add_hyperparameters(
        self, options: Mapping[str, Any], metrics: Mapping[str, float], step: int
    ) -> None:
        """Add what the HParams tab lists: options as JSON has them, and what a run with these came to.

        Of a run that ends more than once, since it was made longer, TensorBoard keeps the first options and
        shows the last metrics. So what may have changed by then must be no option.
        """
        flat = {name: _as_scalar(value) for name, value in options.items()}
        # Not SummaryWriter.add_hparams, which writes into another file.
        for summary in hparams(flat, dict(metrics)):
            self._writer._get_file_writer().add_summary(summary, step)
        self.add_scalars(metrics, step)

    def close(self) -> None:
        """Write what is not written yet."""
        self._writer.close()

    def _add_picture(self, name: str, picture: NDArray[np.uint8], step: int) -> None:
        self._writer.add_image(name, picture, step, dataformats="HWC")


def _as_scalar(value: Any) -> int | float | str:
    return value if isinstance(value, int | float | str) else json.dumps(value)

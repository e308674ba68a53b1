"""Advantages relative to a group of swarms that began alike.

The luck of a start is common to a group, and the mean of the group takes it out of the advantages. Source:
Z. Shao et al., "DeepSeekMath", arXiv 2402.03300 (2024). Unlike there, advantages are not divided by the
group's standard deviation: the mean return is the objective.

Noise that is held for several steps earns one advantage, of the step in which it was drawn. Otherwise
the later steps of the same noise would be praised for its later gains, and not blamed for its earlier costs;
policies learned so ended with too large populations.
"""

from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    import torch

Array = TypeVar("Array", NDArray[np.floating], "torch.Tensor")


def relative_to_group(advantages: Array, group_size: int, noise_steps: int = 1) -> Array:
    """Return advantages of the steps in which the noise was drawn, minus their mean over the group.

    Args:
        advantages: (steps, B), an array of NumPy or a tensor.
        group_size: number of swarms in a group, neighbours.
        noise_steps: number of steps that share their noise; 0 is a whole episode.
    """
    held = noise_steps or len(advantages)
    drawn: Any = advantages[[step // held * held for step in range(len(advantages))]]
    if group_size == 1:
        return drawn
    groups = drawn.reshape(len(drawn), -1, group_size)
    return (groups - groups.mean(axis=2, keepdims=True)).reshape(drawn.shape)

"""The state of a CMA-ES of the package `cmaes`, as arrays: its own way of storing itself is a pickle."""

import numpy as np
from cmaes import CMA, SepCMA
from numpy.typing import NDArray

Arrays = dict[str, NDArray]


def strategy_state(strategy: CMA | SepCMA) -> Arrays:
    """Everything that changes in a strategy between `tell` and `ask`, as arrays without objects."""
    state = {
        f"strategy.{name}": np.asarray(value)
        for name, value in vars(strategy).items()
        if name != "_rng" and value is not None
    }
    _, keys, *numbers = strategy._rng.get_state()
    return {
        **state,
        "generator.keys": np.asarray(keys, dtype=np.int64),
        "generator.numbers": np.array(numbers, dtype=float),
    }


def load_strategy(strategy: CMA | SepCMA, state: Arrays) -> None:
    """Make a strategy go on from a state."""
    for name in vars(strategy):
        if name != "_rng":
            value = state.get(f"strategy.{name}")  # absent where it was None
            setattr(strategy, name, value.item() if value is not None and value.ndim == 0 else value)
    place, has_gauss, gauss = state["generator.numbers"].tolist()
    keys = state["generator.keys"].astype(np.uint32)
    strategy._rng.set_state(("MT19937", keys, int(place), int(has_gauss), gauss))

"""The state of a learner of stable-baselines3 between two rollouts of a chunk, from which it goes on exactly.

Besides networks and counters, that is the state of random generators and what the library keeps of rollouts.
Environments are not stored: in a chunk whose rollouts are whole episodes, resets from the chunk's seed lead
to the same episodes.
"""

from collections import deque
from collections.abc import Mapping
from typing import Any

import numpy as np
import torch
from stable_baselines3.common.base_class import BaseAlgorithm
from stable_baselines3.common.utils import set_random_seed

State = dict[str, object]


def stopped_state(model: BaseAlgorithm, rollouts: int) -> State:
    """Return the state of a model of the library after some rollouts of a chunk.

    Args:
        model: PPO of stable-baselines3 or sb3-contrib, or DQN.
        rollouts: rollouts of the chunk so far, each with its update.
    """
    # The library draws from NumPy's global generator.
    _, keys, place, has_gauss, gauss = np.random.get_state(legacy=True)  # noqa: NPY002
    return {
        "rollouts": rollouts,
        "torch": torch.get_rng_state(),
        "numpy_keys": torch.as_tensor(np.asarray(keys, dtype=np.int64)),
        "numpy_numbers": [int(place), int(has_gauss), float(gauss)],
        "ended": [_plain(episode) for episode in model.ep_info_buffer or ()],
        "logged": _plain(model.logger.name_to_value),
    }


def go_on(model: BaseAlgorithm, state: Mapping[str, object], seed: int) -> None:
    """Bring a model and its environments to a state of the chunk that has this seed.

    Networks and counters must be loaded already.
    """
    library: Any = model
    stored: Any = state
    env = library.get_env()
    set_random_seed(seed)
    env.seed(seed)
    for _ in range(stored["rollouts"] + 1):
        library._last_obs = env.reset()
    library._last_episode_starts = np.ones(env.num_envs, dtype=bool)
    library.ep_info_buffer = deque(stored["ended"], maxlen=library._stats_window_size)
    library.ep_success_buffer = deque(maxlen=library._stats_window_size)
    library.logger.name_to_value.update(stored["logged"])
    torch.set_rng_state(stored["torch"])
    place, has_gauss, gauss = stored["numpy_numbers"]
    keys = stored["numpy_keys"].numpy().astype(np.uint32)
    np.random.set_state(("MT19937", keys, place, has_gauss, gauss))  # noqa: NPY002


def _plain(numbers: Mapping[str, Any]) -> dict[str, float]:
    """Return numbers by name without NumPy's types, which a checkpoint does not hold."""
    return {name: value if isinstance(value, int) else float(value) for name, value in numbers.items()}

"""Layouts and rewards by what they are for."""

from swarm_gym.observation import OBSERVATIONS
from swarm_gym.reward import NEED_BITS, REWARDS

# Those that do not count the ones of bit strings.
OF_SWARMS = [
    name
    for name, layout in OBSERVATIONS.items()
    if not any(feature.needs_bits for feature in layout.features)
]
REWARDS_OF_SWARMS = [name for name in REWARDS if name not in NEED_BITS]

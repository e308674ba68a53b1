"""Layouts and rewards by what they are for."""

from swarm_gym.observation import OBSERVATIONS
from swarm_gym.reward import NEED_BITS, REWARDS

# Those that count neither the ones of bit strings nor restarts, and read no state of an optimizer.
OF_SWARMS = [
    name
    for name, layout in OBSERVATIONS.items()
    if not any(f.needs_bits or f.needs_restarts or f.needs_search for f in layout.features)
]
REWARDS_OF_SWARMS = [name for name in REWARDS if name not in NEED_BITS]

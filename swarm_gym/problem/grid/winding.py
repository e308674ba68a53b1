"""Grid maps on which every path turns back on its way, so that waypoints cannot follow it.

Waypoints stand at growing distances along the straight line from start to target.
"""

import warnings
from collections.abc import Sequence
from functools import lru_cache

import numpy as np

from swarm_gym.errors import shown
from swarm_gym.scenarios import GridScenario


def warn_of_winding(scenarios: Sequence[GridScenario]) -> None:
    """Warn once if there are scenarios whose paths all turn back on their way."""
    winding = [scenario.name for scenario in scenarios if not has_forward_path(scenario)]
    if winding:
        others = f", and on {len(winding) - 1} more of {len(scenarios)}" if len(winding) > 1 else ""
        warnings.warn(
            f"scenario {shown(winding[0])}{others}: every path turns back on its way, and paths of waypoints "
            "cannot; choose encoding 'bezier', or plan with swarm_gym.plan",
            stacklevel=2,
        )


@lru_cache(maxsize=1024)
def has_forward_path(scenario: GridScenario) -> bool:
    """Return whether steps between free neighbouring cells lead to the target, none of them away from it.

    Away means back along the straight line from start to target.
    """
    from scipy.ndimage import binary_propagation

    (column, row), (to_column, to_row) = map(scenario.map.cell_of, (scenario.start, scenario.target))
    rows, columns = np.mgrid[-1:2, -1:2]
    forward = rows * (to_row - row) + columns * (to_column - column) >= 0
    reached = np.zeros_like(scenario.map.blocked)
    reached[row, column] = True
    reached = binary_propagation(reached, forward, mask=~scenario.map.blocked)
    return bool(reached[to_row, to_column])

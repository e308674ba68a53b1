"""Wrappers of vectors of swarms for any learner: episodes in groups, and rewards relative to a controller.

| name | what it does |
|---|---|
| `GroupedEpisodes` | swarms of a group share seed, scenario, price and the states of their first iterations |
| `relative_to_group` | advantages minus their mean over the group |
| `PairedReward` | subtracts what a reference controller earns from the same start |

`python -m agents.train` trains with the same parts. The option `base` of environments, with which actions are
corrections of a controller, goes with all of them.
"""

from swarm_gym.wrappers.grouped_episodes import GroupedEpisodes
from swarm_gym.wrappers.groups import relative_to_group
from swarm_gym.wrappers.paired_reward import PairedReward

__all__ = ["GroupedEpisodes", "PairedReward", "relative_to_group"]

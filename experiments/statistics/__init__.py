"""Statistics of heavy-tailed runs on equal scenarios and seeds; smaller values are better."""

from experiments.statistics.comparison import (
    Comparison,
    Difference,
    compare,
    difference,
    holm,
    mean_difference,
    paired,
    probability_of_improvement,
    rank_sum,
    ratio_interval,
    superiority,
)
from experiments.statistics.curves import Profile, hypervolume, non_dominated, performance_profile
from experiments.statistics.samples import (
    GroupSummary,
    Summary,
    mean_interval,
    summarise,
    summarise_group,
)
from swarm_gym.comparing.bootstrap import (
    Draws,
    Interval,
    draw,
    interval,
    mean_of_present,
    means,
    trimmed_means,
)

__all__ = [
    "Comparison",
    "Difference",
    "Draws",
    "GroupSummary",
    "Interval",
    "Profile",
    "Summary",
    "compare",
    "difference",
    "draw",
    "holm",
    "hypervolume",
    "interval",
    "mean_difference",
    "mean_interval",
    "mean_of_present",
    "means",
    "non_dominated",
    "paired",
    "performance_profile",
    "probability_of_improvement",
    "rank_sum",
    "ratio_interval",
    "summarise",
    "summarise_group",
    "superiority",
    "trimmed_means",
]

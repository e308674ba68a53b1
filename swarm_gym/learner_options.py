"""Options of environments with which plain learners of other libraries learn best.

`swarm_gym.sb3.make_vec` begins with them. Other learners get the same environments from Gymnasium:

    options = learner_options("firefly", scenario=["case1", "case2", "case3"])
    envs = gymnasium.make_vec("swarm_gym/Firefly-v0", num_envs=64, **options)

Rewards add up to what an episode has found, so use a discount of 1 with these options.
"""

import warnings
from collections.abc import Mapping

from swarm_gym.action_layouts import layout_of
from swarm_gym.optimizers import get_optimizer
from swarm_gym.scenarios import OneMaxScenario, drive_of, worlds_of
from swarm_gym.settings import Settings

# Layouts in natural units, and those for networks that observe or decide the same.
FOR_NETWORKS: Mapping[str, Mapping[str, str]] = {
    "observation": {"paper": "scaled", "theory": "theory-scaled"},
    "action": {"natural": "centred", "extended": "extended-centred", "sourced": "sourced-centred"},
}
# Layouts of corrections, by the layout in which the corrected controller decides.
FOR_CORRECTIONS: Mapping[str, str] = {**FOR_NETWORKS["action"], "sourced": "sourced-normalised"}
# First members where centred actions decide sources, as in the layout `sourced-centred`. The mean gap of a
# policy that decides 0 throughout is 0.6 per cent with them, and 1.5 per cent with uniform ones.
FIRST_MEMBERS: Mapping[str, object] = {"source": "smooth", "amplitude": 0.2}
# The gap is measured from a lower bound, which is 4 to 9 per cent below the optimum of the paper's cases. So
# one per cent of the optimum is 0.06 to 0.27 of log(gap) there, and so much shall 100,000 evaluations cost.
PROGRESS: Mapping[str, object] = {"reward": "progress", "price": 0.1}


def learner_options(optimizer: str = "firefly", **given: object) -> dict[str, object]:
    """Return the options of an environment for a learner: those given, and defaults that suit networks.

    Observations are `extended`, actions `centred`, and the reward is `progress` at a price of 0.1: a learner
    is paid in each iteration for what the iteration has found. On bit strings observations are
    `theory-scaled` and the reward is `runtime`; where robots drive, the reward is `detour` at a price of 1.
    Where centred actions decide sources, the first members are smooth bends.

    Args:
        optimizer: a name in `swarm_gym.optimizers.ALL_OPTIMIZERS`.
        given: options of `swarm_gym.settings.Settings` and parameters of the optimizer, which are kept.

    Raises:
        UnknownNameError: for an option, optimizer or scenario that does not exist.
        SettingError: for a value that an option cannot have.
    """
    first = Settings.from_options(get_optimizer(optimizer), given).scenarios[0]
    if isinstance(worlds_of(first)[0].scenario, OneMaxScenario):
        suited: dict[str, object] = {"observation": "theory-scaled", "reward": "runtime"}
    elif drive_of(first) is not None:
        suited = {"observation": "extended", "reward": "detour", "price": 1.0}
    else:
        suited = {"observation": "extended", **PROGRESS}
    options = {"action": "centred", **suited, **given}
    layout = layout_of(str(options["action"]))
    if layout.sourced and layout.size == "centred" and "source" not in given:
        return {**FIRST_MEMBERS, **options}
    return options


def warn_of_unscaled(options: Mapping[str, object]) -> None:
    """Warn of layouts in natural units, whose numbers networks learn badly, and name the scaled ones."""
    for option, scaled in FOR_NETWORKS.items():
        name = options.get(option)
        if isinstance(name, str) and name in scaled:
            warnings.warn(
                f"{option}={name!r} is in natural units, which networks learn badly: population sizes stick "
                f"at a bound; choose {option}={scaled[name]!r}, or scale the numbers yourself",
                UserWarning,
                stacklevel=3,
            )

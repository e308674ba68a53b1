"""Names of own code among training options that stand in a file: a file never imports code."""

from collections.abc import Mapping

from swarm_gym.own_code import refuse_unless_given

# Kind of the names that an option has.
_KINDS = {
    "action": "action layout",
    "also_on": "optimizer",
    "base": "controller",
    "observation": "observation layout",
    "optimizer": "optimizer",
    "reference": "controller",
    "reward": "reward",
    "scenarios": "scenario",
    "validation_scenarios": "scenario",
    "warm_start": "controller",
}


def refuse_own_code(options: Mapping[str, object], where: str) -> None:
    """Raise an error if options of a training that stand in a file name own code.

    Args:
        options: values of training options by name.
        where: the file, for the message.

    Raises:
        OwnCodeError: if a name would import code that was not named outside of files.
    """
    for option, kind in _KINDS.items():
        value = options.get(option, ())
        for text in value if isinstance(value, list | tuple) else [value]:
            for name in str(text).split("+") if kind == "observation layout" else [text]:
                if not _is_ours(kind, name):
                    refuse_unless_given(kind, name, f"{where}: {option}")


def _is_ours(kind: str, name: object) -> bool:
    """Return whether a name is in the registry of its kind."""
    # Imported only now, since the registries import the whole simulation.
    from swarm_gym.action import ACTIONS
    from swarm_gym.controllers import CONTROLLERS
    from swarm_gym.controllers.names import ControllerName
    from swarm_gym.observation import OBSERVATIONS
    from swarm_gym.optimizers import ALL_OPTIMIZERS
    from swarm_gym.reward import REWARDS
    from swarm_gym.scenarios.registry import is_known

    if kind == "controller":
        return ControllerName.parse(str(name)).family in CONTROLLERS
    if kind == "scenario":
        return is_known(name)
    registries: dict[str, Mapping[str, object]] = {
        "action layout": ACTIONS,
        "observation layout": OBSERVATIONS,
        "optimizer": ALL_OPTIMIZERS,
        "reward": REWARDS,
    }
    return name in registries[kind]

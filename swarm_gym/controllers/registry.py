"""Controllers of population size and repair degree, made by name.

To add one: write a subclass of `swarm_gym.controllers.controller.Controller` in a file of its own and enter
it in `CONTROLLERS`.
"""

from collections.abc import Callable
from functools import partial

from swarm_gym.checks import look_up
from swarm_gym.controllers.controller import Controller, SizeLimits
from swarm_gym.controllers.distilled import load_rule
from swarm_gym.controllers.diversity_ladder import DiversityLadder
from swarm_gym.controllers.fixed import Fixed, Random
from swarm_gym.controllers.learned.load import load_learned
from swarm_gym.controllers.linear_reduction import LinearReduction
from swarm_gym.controllers.open_loop import load_open_loop
from swarm_gym.controllers.schedules import SelfAdaptiveSchedule
from swarm_gym.controllers.status_monitor import StatusMonitor
from swarm_gym.controllers.tuned import load_tuned
from swarm_gym.errors import shown

__all__ = ["CONTROLLERS", "Controller", "SizeLimits", "make_controller"]


def _fixed(argument: str, limits: SizeLimits) -> Controller:
    if not argument.isdigit():
        raise ValueError(f"controller 'fixed:{argument}': expected a population size, as fixed:60")
    return Fixed(int(argument), limits)


def _no_argument(make: Callable[[SizeLimits], Controller]) -> Callable[[str, SizeLimits], Controller]:
    def checked(argument: str, limits: SizeLimits) -> Controller:
        if argument:
            raise ValueError(f"this controller takes no argument, got {shown(argument)}")
        return make(limits)

    return checked


def _tuned(argument: str, limits: SizeLimits) -> Controller:
    return make_controller(load_tuned(argument), limits)


# Family name to a function of what stands after the colon and the size limits.
CONTROLLERS: dict[str, Callable[[str, SizeLimits], Controller]] = {
    "fixed": _fixed,
    "spsfa": partial(SelfAdaptiveSchedule.from_argument, treats_infeasible_paths=False),
    "spsfa-tip": partial(SelfAdaptiveSchedule.from_argument, treats_infeasible_paths=True),
    "linear-reduction": LinearReduction.from_argument,
    "diversity-ladder": DiversityLadder.from_argument,
    "status-monitor": StatusMonitor.from_argument,
    "random": _no_argument(Random),
    "open-loop": load_open_loop,
    "learned": load_learned,
    "tuned": _tuned,
    "distilled": load_rule,
}


def make_controller(name: str, limits: SizeLimits = SizeLimits()) -> Controller:  # noqa: B008
    """A controller by name, as `fixed:60`, `spsfa-tip` or `learned:three-cases/0`.

    Parameters follow the name of a schedule or size rule: `spsfa-tip:growth=500,decay=0.1`,
    `linear-reduction:start=120`; a wrong one is refused with the list of those there are. What follows
    `learned:`, `open-loop:`, `tuned:` and `distilled:` is shipped under that name, or a file. Policies of one
    recipe are `learned:<preset>/<training seed>`; one that sees the price of evaluations is told it:
    `learned:<policy>@0.3`.

    Args:
        name: the family, and after a colon its argument.
        limits: the population sizes that the environment allows.

    Raises:
        UnknownNameError: for an unknown family; the message lists the valid ones.
        ValueError: for an argument that the family cannot take.
        PolicyFileError: for a policy that is missing, damaged or made for something else.
    """
    family, _, argument = str(name).partition(":")
    return look_up("controller", family, CONTROLLERS)(argument, limits)

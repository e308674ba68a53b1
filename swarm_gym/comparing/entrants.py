"""Entrants of suites: a controller, its optimizer and the length of its episodes; and these episodes.

`spsfa-tip` is a controller of the suite's own optimizer. `multivariate+fixed:65` is the controller `fixed:65`
of the optimizer `multivariate`. `multivariate(50)+fixed:65` runs in episodes of 50 iterations; it is another
entrant, since parameters may follow a schedule over the episode.
"""

from collections.abc import Iterable, Iterator, Mapping
from typing import Any, NamedTuple

import gymnasium
from numpy.typing import NDArray

from swarm_gym.checks import look_up
from swarm_gym.controllers.controller import Controller
from swarm_gym.controllers.names import ControllerName
from swarm_gym.errors import SettingError
from swarm_gym.optimizers import ALL_OPTIMIZERS, get_optimizer
from swarm_gym.own_code import is_own
from swarm_gym.registration import environment_id

WAYPOINTS = "waypoints"  # the default of environments, or what stands for it on kinds of maps without them


class Entrant(NamedTuple):
    """Names of an optimizer and of a controller for it, and the number of iterations.

    Attributes:
        optimizer: name of the optimizer.
        controller: name for `make_controller`.
        iterations: length of an episode; None is the suite's own.
    """

    optimizer: str
    controller: str
    iterations: int | None = None

    @property
    def options(self) -> dict[str, int]:
        """Options of the environment that differ from the suite's."""
        return {} if self.iterations is None else {"iterations": self.iterations}


def entrant(name: str, optimizer: str) -> Entrant:
    """Return the entrant of that name; `optimizer` is used where the name has none.

    Raises:
        UnknownNameError: if the name has an optimizer that does not exist.
        OwnCodeError: if the name has an optimizer of own code that cannot be imported.
    """
    parts = ControllerName.parse(name)
    if parts.optimizer is not None:
        if not is_own("optimizer", parts.optimizer):
            look_up(f"optimizer in {name!r}:", parts.optimizer, ALL_OPTIMIZERS)
        get_optimizer(parts.optimizer)
    return Entrant(parts.optimizer or optimizer, str(parts.controller), parts.iterations)


def with_encoding(optimizers: Iterable[str], options: Mapping[str, object]) -> dict[str, object]:
    """Return the options of environments with the encoding that these optimizers have, where none is given.

    Optima depend on it.

    Raises:
        SettingError: if the optimizers have different ones by default, whose costs cannot be compared.
    """
    if "encoding" in options:
        return dict(options)
    known = {name: get_optimizer(name).encodings[0] for name in optimizers}
    found = sorted(set(known.values()))
    if len(found) > 1:
        listed = ", ".join(f"{encoding!r} of {name}" for name, encoding in known.items())
        raise SettingError(f"optimizers have different encodings, whose costs cannot be compared: {listed}")
    return dict(options) if found in ([], [WAYPOINTS]) else {**options, "encoding": found[0]}


def options_of(runs: Entrant, controller: Controller, options: Mapping[str, object]) -> dict[str, object]:
    """Return the options of an entrant's environments: those of all, its own, what its controller needs."""
    return controller.options_with({**options, **runs.options})


def environment_of(
    runs: Entrant, controller: Controller, scenario: str, options: Mapping[str, object]
) -> gymnasium.Env[NDArray, NDArray]:
    """Return the environment in which an entrant runs.

    Args:
        runs: optimizer of the entrant, and the length of its episodes.
        controller: controller of the entrant, whose layouts and limits the environment has.
        scenario: name of a scenario.
        options: options of all environments that are compared.
    """
    chosen: dict[str, Any] = options_of(runs, controller, options)
    return gymnasium.make(environment_id(runs.optimizer), scenario=scenario, **chosen)


def iterate(
    env: gymnasium.Env[NDArray, NDArray],
    controller: Controller,
    seed: int,
    options: dict[str, object] | None = None,
) -> Iterator[dict[str, object]]:
    """Run an episode; yield the info of its first population, then that after every iteration.

    Args:
        env: environment of one swarm.
        controller: controller with the layouts of the environment.
        seed: seed of both.
        options: reset options of the environment.
    """
    controller.reset(1, seed)
    observation, info = env.reset(seed=seed, options=options)
    yield info
    ended = False
    while not ended:
        observation, _, ended, _, info = env.step(controller.act(observation[None])[0])
        yield info

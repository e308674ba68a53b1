"""Episodes of a controller in a single environment, one iteration at a time."""

from collections.abc import Iterator, Mapping
from typing import Any

import gymnasium
from numpy.typing import NDArray

from swarm_gym.comparing.entrants import Entrant
from swarm_gym.controllers.controller import Controller
from swarm_gym.registration import environment_id


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
    chosen: dict[str, Any] = {**options, **runs.options, **controller.env_options()}
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
        controller: controller, whose layouts are those of the environment.
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

"""Open loops that begin again when the best fitness rises."""

import numpy as np
import pytest

from swarm_gym.controllers import make_controller
from swarm_gym.controllers.open_loop import OpenLoopFileError
from swarm_gym.history import HISTORY
from swarm_gym.vector_env import SwarmVectorEnv

NAME = "three-cases-sourced/0@1"
SWARMS, BEST = 6, HISTORY.index("best_fitness")


def episode(name, scenario, iterations=60):
    """Return the decisions of an episode, (iterations, B, k), and the best fitness after each, (B, ...)."""
    controller = make_controller(name)
    envs = SwarmVectorEnv(num_envs=SWARMS, scenario=scenario, **controller.env_options())
    controller.reset(SWARMS)
    observations, _ = envs.reset(seed=3)
    decided = []
    for _ in range(iterations):
        decided.append(controller.act(observations))
        observations, *_ = envs.step(decided[-1])
    return np.array(decided), envs.simulation.history[:, : iterations + 1, BEST]


def test_the_loop_begins_again_where_the_best_fitness_rises_and_nowhere_else():
    decided, best = episode(f"reacting-loop:{NAME}", "dynamic:case2-block@40")
    loop = make_controller(f"open-loop:{NAME}").decisions
    rose = best[:, 40] > best[:, 39]
    assert rose.sum() >= 2
    for swarm in range(SWARMS):
        clock = np.arange(60)
        if rose[swarm]:
            clock[40:] -= 40
        np.testing.assert_array_equal(decided[:, swarm], loop[clock])


def test_on_a_map_that_stays_it_is_the_open_loop():
    np.testing.assert_array_equal(
        episode(f"reacting-loop:{NAME}", "case1")[0], episode(f"open-loop:{NAME}", "case1")[0]
    )


def test_a_reacting_loop_has_the_options_of_the_open_loop_but_sees_more():
    reacting, loop = (
        make_controller(f"{family}:{NAME}").env_options() for family in ("reacting-loop", "open-loop")
    )
    assert reacting.pop("observation") == "paper+jumps"
    assert {**reacting, "observation": "paper"} == loop


@pytest.mark.parametrize("argument", ["", "no-such-loop", "three-cases@9"])
def test_other_names_are_refused(argument):
    with pytest.raises(OpenLoopFileError):
        make_controller(f"reacting-loop:{argument}")


def test_controllers_around_others_are_stretched_with_them():
    loop = make_controller("reacting-loop:dynamic-reacting/0@1")
    assert list(loop.stretched(2).loop.knots.iterations) == list(loop.loop.stretched(2).knots.iterations)
    assert loop.stretched(2).identity() != loop.identity()
    together = make_controller("together:three-cases@1").stretched(4)
    alone = make_controller("learned:three-cases/0@1")
    knots = list(alone.stretched(4).corrects.knots.iterations)
    assert knots == [4 * knot for knot in alone.corrects.knots.iterations]
    assert list(together.corrects.knots.iterations) == knots
    assert all(list(part.corrects.knots.iterations) == knots for part in together._parts)
    base = alone._base
    assert base.iteration_unit == 1
    assert base.stretched(4).corrected_from == 4 * base.corrected_from

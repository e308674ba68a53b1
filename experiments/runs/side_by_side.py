"""Runs that differ in their seeds only, side by side in a vector of swarms.

They are those of `Episode`, bit for bit. They take less time, since a controller decides for all swarms at
once, and no infos are made in between.
"""

import time
from collections.abc import Mapping, Sequence
from typing import Any

from gymnasium.vector import AutoresetMode

from agents import CONTROLLERS
from experiments.runs.episode import controller_of, warm_up
from experiments.runs.experiment import Experiment
from experiments.runs.run import Run
from swarm_gym.comparing.entrants import entrant, options_of
from swarm_gym.controllers.names import BLINDED, ControllerName
from swarm_gym.optimizers import ALL_OPTIMIZERS
from swarm_gym.rollout import run_swarms
from swarm_gym.vector_env import SwarmVectorEnv


def can_be_side_by_side(controller: str, scenario: str, seeds: Sequence[int], experiment: Experiment) -> bool:
    """Return whether runs of these seeds can be made side by side.

    There must be several seeds, one after the other, and no population to keep. Own code runs alone, since it
    may know single environments only.
    """
    runs = entrant(controller, experiment.optimizer)
    family = ControllerName.parse(runs.controller).family
    return (
        len(seeds) > 1
        and list(seeds) == list(range(seeds[0], seeds[0] + len(seeds)))
        and not any(experiment.kept_iterations((controller, scenario, seed)) for seed in seeds)
        and runs.optimizer in ALL_OPTIMIZERS
        and family in (*CONTROLLERS, BLINDED)
    )


def run_side_by_side(
    controller: str, scenario: str, seeds: Sequence[int], experiment: Experiment, made_with: Mapping[str, str]
) -> list[Run]:
    """Carry out runs of consecutive seeds, and return their records in order.

    The processor time of each is its share of the time of all.

    Args:
        controller: name of the controller in the experiment.
        scenario: name of the scenario.
        seeds: the seeds, one after the other.
        experiment: experiment that gives the optimizer and the options.
        made_with: versions and commit that the runs are made with.
    """
    runs = entrant(controller, experiment.optimizer)
    warm_up(runs, experiment)
    decides = controller_of(runs.controller)
    options: dict[str, Any] = options_of(runs, decides, experiment.options)
    swarms = SwarmVectorEnv(
        len(seeds),
        runs.optimizer,
        autoreset_mode=AutoresetMode.DISABLED,
        num_threads=1,
        scenario=scenario,
        **options,
    )
    begin = time.process_time()
    run_swarms(decides, swarms, range(seeds[0], seeds[0] + len(seeds)))
    seconds = (time.process_time() - begin) / len(seeds)
    simulation, final = swarms.simulation, swarms.simulation.swarms
    paths = simulation.paths.best()
    return [
        Run(
            controller,
            scenario,
            seed,
            float(final.best_fitness[row]),
            float(final.best_collision[row]),
            int(final.evaluations[row]),
            seconds,
            paths[row].copy(),
            simulation.history[row].copy(),
            made_with,
            columns=simulation.columns,
            trajectory=simulation.trajectory(row),
        )
        for row, seed in enumerate(seeds)
    ]

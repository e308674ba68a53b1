"""A tuning run: rounds until the steps are spent, then the result with its manifest."""

import dataclasses
from pathlib import Path
from typing import Any

from tqdm import tqdm

from swarm_gym.checks import require_integer
from swarm_gym.controllers.controller import Controller
from swarm_gym.outputs import require_outputs
from swarm_gym.runs.folder import RunFolderError, as_json, prepare_folder
from swarm_gym.runs.provenance import provenance
from swarm_gym.runs.seeds import training_seed
from swarm_gym.tuning.config import TuneConfig
from swarm_gym.tuning.side_by_side import SideBySide
from swarm_gym.tuning.tuners import make_tuner

ESTIMATE_EPISODES = 300  # with training seeds that the search did not use; nothing is chosen by them
ESTIMATE = 10**9  # stands for the number of a round in the seeds of these episodes

# Options that do not change the results of a run; in addition, a resumed run may be longer.
_LOCATION = ("runs", "name", "resume", "output", "threads")


class TuningRun:
    """A tuning run in a folder: configuration, checkpoint or study, result."""

    def __init__(self, config: TuneConfig):
        self.config = config
        require_integer("episodes", config.episodes, 1)
        require_integer("seed", config.seed, 0)
        # Read once, since the imported code is what runs, whatever changes on the disk.
        self.provenance = provenance("cmaes", "gymnasium", "numba", "numpy", "optuna")
        self.tuner = make_tuner(config)
        if config.total_steps < self.tuner.steps_per_round:
            raise RunFolderError(
                f"total_steps {config.total_steps}: one round takes {self.tuner.steps_per_round}; "
                "raise it, or lower episodes or candidates"
            )
        if config.output:
            require_outputs([config.output])
            if config.output.exists() and not config.resume:
                raise RunFolderError(
                    f"--output {config.output} exists already; name another file or delete it"
                )
        # Created only now, so that an invalid configuration leaves no folder.
        self._lock = prepare_folder(
            config.folder, dataclasses.asdict(config), config.resume, (*_LOCATION, "total_steps")
        )
        self.tuner.open(config.folder)

    @property
    def num_steps(self) -> int:
        """Environment steps of the search so far."""
        return self.tuner.rounds * self.tuner.steps_per_round

    def run(self) -> Path:
        """Tune to the end; return the file of the result."""
        try:
            return self._run()
        finally:
            self._lock.release()

    def _run(self) -> Path:
        config, tuner = self.config, self.tuner
        with tqdm(total=config.total_steps, initial=self.num_steps, unit="step", desc=config.what) as bar:
            while self.num_steps + tuner.steps_per_round <= config.total_steps:
                shown = tuner.advance()
                bar.set_postfix({name: f"{value:.4f}" for name, value in shown.items()})
                bar.update(tuner.steps_per_round)
        manifest = self._manifest(self._estimate(tuner.result()))
        path = config.folder / f"{config.what}.json"
        for place in (path, config.output):
            if place is not None:
                tuner.write(place, manifest)
        return config.output or path

    def _estimate(self, controller: Controller) -> dict[str, Any]:
        """Return mean results of the tuned controller on separate episodes, by scenario."""
        config = dataclasses.replace(self.config, episodes=ESTIMATE_EPISODES)
        places = SideBySide(config, 1, controller.observation, controller.action)
        return places.run([controller], training_seed(config.seed, ESTIMATE)).by_scenario(0)

    def _manifest(self, estimate: dict[str, Any]) -> dict[str, Any]:
        config = self.config
        first = training_seed(config.seed, ESTIMATE)
        return {
            "config": {k: v for k, v in as_json(dataclasses.asdict(config)).items() if k not in _LOCATION},
            "rounds": self.tuner.rounds,
            "steps": self.num_steps,
            "round_seeds": self.tuner.seeds(),
            "estimate": estimate,
            "estimate_seeds": [first, first + ESTIMATE_EPISODES],
            "provenance": self.provenance,
        }

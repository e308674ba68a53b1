"""Parameters of a controller tuned by Optuna.

Source: T. Akiba et al., "Optuna: a next-generation hyperparameter optimization framework", KDD 2019. Source
of its sampler: J. Bergstra et al., "Algorithms for hyper-parameter optimization", NIPS 24 (2011), in the
multivariate form. All trials have the same episodes, since the best trial is the result, and with different
episodes it would be the luckiest. Few parameters can hardly overfit the episodes, and the estimate in the
result is computed on others.
"""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import optuna
from optuna.distributions import BaseDistribution, FloatDistribution, IntDistribution
from optuna.exceptions import StorageInternalError
from optuna.trial import FrozenTrial, TrialState, create_trial
from sqlalchemy.exc import SQLAlchemyError

from swarm_gym.controllers import make_controller
from swarm_gym.controllers.controller import Controller
from swarm_gym.controllers.names import ControllerName
from swarm_gym.controllers.parameters import Number, format_parameters
from swarm_gym.controllers.tuned import save_tuned
from swarm_gym.runs.folder import RunFolderError
from swarm_gym.runs.seeds import training_seed
from swarm_gym.tuning.config import TuneConfig, Tuner
from swarm_gym.tuning.parameter_spaces import ParameterSpace, Span
from swarm_gym.tuning.side_by_side import SideBySide

FIRST_SIZES = ("start", "initial_population_size")  # parameters that are the size of a first population
DIGITS = 4  # significant digits of a parameter; 48 noisy episodes do not justify more


class ParameterTuner(Tuner):
    """Optuna on the parameters of a family of controllers; a round is a trial."""

    family = "tuned"

    def __init__(self, config: TuneConfig, space: ParameterSpace):
        self._config = config
        self._space = space
        self._spans = {
            name: span.within(config.first_limits if name in FIRST_SIZES else config.limits)
            for name, span in space.spans.items()
        }
        first = self._controller(self._first())
        self._places = SideBySide(config, 1, first.observation, first.action)
        self.steps_per_round = self._places.steps

    def open(self, folder: Path) -> None:
        """Create or load the study; a trial that was killed is repeated."""
        path = self._path = folder / "study.db"
        optuna.logging.set_verbosity(optuna.logging.WARNING)
        try:
            self._study = optuna.create_study(
                storage=f"sqlite:///{path.resolve()}", study_name="tune", load_if_exists=True
            )
            trials = self._study.get_trials(deepcopy=False)
        except Exception as error:
            raise RunFolderError(f"{path}: not a readable study ({error})") from error
        with self._writing():
            for trial in trials:
                if not trial.state.is_finished():
                    self._study.tell(trial.number, state=TrialState.FAIL)
        self.rounds = len(self._completed())

    def advance(self) -> dict[str, float]:
        """Run one trial; the first one has the first parameters of the space."""
        distributions = {name: _distribution(span) for name, span in self._spans.items()}
        if self.rounds == 0:
            params = self._first()
            loss = self._loss(params)
            with self._writing():
                self._study.add_trial(create_trial(params=params, distributions=distributions, value=loss))
        else:
            # Seeded by the number of the trial, so that a resumed study equals one that was not stopped.
            seed = np.random.SeedSequence([self._config.seed, self.rounds]).generate_state(1)[0]
            self._study.sampler = optuna.samplers.TPESampler(
                multivariate=True, constant_liar=False, seed=int(seed)
            )
            with self._writing():
                trial = self._study.ask(distributions)
            loss = self._loss(trial.params)
            with self._writing():
                self._study.tell(trial, loss)
        self.rounds += 1
        return {"loss": loss, "best": float(self._study.best_value)}

    def seeds(self) -> list[int]:
        """Return the first seed of the episodes, which are the same for all trials."""
        return [training_seed(self._config.seed, 0)]

    def result(self) -> Controller:
        """Return the controller of the best trial."""
        return self._controller(self._best().params)

    def write(self, path: Path, manifest: Mapping[str, object]) -> None:
        """Write the file that `tuned:<path>` reads."""
        best = self._best()
        found = {"best_trial_loss": best.value, "first_trial_loss": self._completed()[0].value}
        save_tuned(path, self._name(best.params), {**manifest, **found})

    @contextmanager
    def _writing(self) -> Iterator[None]:
        try:
            yield
        except (StorageInternalError, SQLAlchemyError) as error:
            raise RunFolderError(
                f"{self._path}: cannot be written ({error.__cause__ or error}); --resume continues after the "
                "last round"
            ) from error

    def _loss(self, params: Mapping[str, Number]) -> float:
        outcomes = self._places.run([self._controller(params)], training_seed(self._config.seed, 0))
        return float(outcomes.losses.mean())

    def _completed(self) -> list[FrozenTrial]:
        return self._study.get_trials(deepcopy=False, states=(TrialState.COMPLETE,))

    def _best(self) -> FrozenTrial:
        return min(self._completed(), key=lambda trial: (trial.value, trial.number))

    def _first(self) -> dict[str, Number]:
        return {
            name: type(value)(min(max(value, self._spans[name].low), self._spans[name].high))
            for name, value in self._space.first.items()
        }

    def _controller(self, params: Mapping[str, Number]) -> Controller:
        return make_controller(self._name(params), self._config.limits)

    def _name(self, params: Mapping[str, Number]) -> str:
        """Return the controller's name; trials are evaluated by name, with rounded parameters."""
        values = {
            name: value if isinstance(value, int) else float(f"{value:.{DIGITS}g}")
            for name, value in params.items()
        }
        return str(ControllerName(self._space.family, parameters=format_parameters(values)))


def _distribution(span: Span) -> BaseDistribution:
    if span.size or span.integer:
        return IntDistribution(int(span.low), int(span.high), log=span.logarithmic)
    return FloatDistribution(span.low, span.high, log=span.logarithmic)

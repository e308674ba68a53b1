"""The options of a training run, a dataclass from which the command line is made.

Those of its learning algorithm are in `swarm_gym.training.algorithms`. All options stand side by side on
command lines, in the stored configuration of a run and in a policy's manifest. There `algorithm` is the name
of the algorithm. Earlier versions stored the options of all algorithms with every run. Of these,
`stored_config` leaves out those that the algorithm of the run lacks: they had no effect.
"""

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypedDict, cast

import tyro

from swarm_gym.checks import look_up
from swarm_gym.controllers.size_limits import SizeLimits
from swarm_gym.training.algorithms import (
    ALGORITHMS,
    EVERY_OPTION,
    PPO,
    AnyAlgorithm,
    foreign_options,
    option_names,
    refuse_foreign,
)
from swarm_gym.training.own_names import refuse_own_code

# The paired reward: the policy's final result relative to a reference controller's from the same start, see
# `swarm_gym.wrappers.paired_reward`; and the reward of the environments from which it is computed.
PAIRED = "paired"
ENV_REWARD = "final-gap"

# Options that exist on some kinds of scenarios only.
_OF_SOME_KINDS = ("encoding", "distance_weight", "ground_weight", "curvature_weight", "cost", "source")


class EnvOptions(TypedDict, total=False):
    """Options of the environments of a training, as `SwarmEnv` has them."""

    encoding: str
    distance_weight: float
    ground_weight: float
    curvature_weight: float
    cost: str
    source: str
    iterations: int
    min_population_size: int
    max_population_size: int
    reward: str
    price: float | tuple[float, ...]
    max_evaluations: int | None


@dataclass(frozen=True)
class TrainConfig:
    """Options of a training run; all are stored with the policy."""

    preset: str = "three-cases"
    """Preset that gives the defaults of all other options, a name or a TOML file, e.g. three-cases-linear."""
    name: str = ""
    """Name of the run, whose folder is <runs>/<name>; by default <preset>/<seed>."""
    runs: Path = Path("runs")
    """Folder of all runs; it is created if it is missing."""
    resume: bool = False
    """Resume the stopped run of that name from its last checkpoint."""
    threads: int = 1
    """Number of threads for the swarms. Results do not depend on it; more than one thread slows torch."""
    seed: int = 0
    """Seed of all random numbers of the run."""
    total_steps: int = 640_000
    """Number of environment steps, summed over all swarms; the last chunk is always completed."""
    optimizer: str = "firefly"
    """Optimizer that the policy controls, e.g. firefly or fish-swarm."""
    scenarios: tuple[str, ...] = ("case1", "case2", "case3")
    """Scenarios that episodes draw from, e.g. case1 case2 or random-fields:train:0-511."""
    encoding: str = "waypoints"
    """Meaning of decision vectors: waypoints, bezier on grid maps, or shifted and spherical over terrain."""
    distance_weight: float = 0.0
    """Weight of the cost of nearness to blocked cells along a path, on grid maps."""
    ground_weight: float = 0.0
    """Weight of the costs of ground along a path, on grid maps that have such costs."""
    curvature_weight: float = 0.0
    """Weight of the squared curvature of a path, in map units squared, on grid maps."""
    cost: str = "documented"
    """Cost of flights over terrain: documented, or metabox for the published one."""
    source: str = "uniform"
    """Source of new members: uniform, smooth or guided. Actions that decide sources decide their shares."""
    iterations: int = 100
    """Length of an episode in iterations of the optimizer."""
    num_swarms: int = 64
    """Number of swarms that run side by side."""
    initial_population_size: int = 80
    """Population size at the start of an episode, PS(0). A base that states the source of its first
    population states the size, too."""
    min_population_size: int = 2
    """Smallest population size that the policy can choose."""
    max_population_size: int = 200
    """Largest population size that the policy can choose."""
    observation: str = "extended"
    """Observation layout of the policy, e.g. extended, or extended+priced to observe the price."""
    action: str = "normalised"
    """Action layout of the policy, one that is scaled to [-1, 1], e.g. extended-normalised."""
    max_evaluations: int = 0
    """Evaluation budget of an episode; 0 is no budget."""
    reward: str = "progress"
    """Reward, e.g. progress; paired is log(final gap) of the reference minus that of the policy."""
    reference: str = "spsfa-tip"
    """Controller that a paired reward compares with."""
    price: tuple[float, ...] = (0.17,)
    """Price of 100,000 evaluations in units of the reward, or the range that episodes draw it from."""
    base: str = "none"
    """Controller whose decisions the policy corrects, e.g. open-loop:three-cases; none for no base."""
    corrected_from: int = 0
    """First iteration, counted from 0, in which the policy corrects its base; the base acts alone before."""
    hidden_layers: tuple[int, ...] = (64, 64)
    """Sizes of the hidden tanh layers of the policy, and of the critic where there is one."""
    rollouts_per_chunk: int = 10
    """Number of rollouts, or generations, per chunk; a chunk ends with validation and a checkpoint."""
    validation_scenarios: tuple[str, ...] = ()
    """Scenarios for validation, where a range counts as one scenario; by default those of the training."""
    validation_seeds: int = 64
    """Number of validation episodes per scenario."""
    algorithm: tyro.conf.OmitArgPrefixes[tyro.conf.AvoidSubcommands[AnyAlgorithm]] = PPO()  # noqa: RUF009
    """Learning algorithm with its options."""

    @property
    def folder(self) -> Path:
        """Folder of the run."""
        return self.runs / (self.name or f"{self.preset}/{self.seed}")

    @property
    def optimizers(self) -> tuple[str, ...]:
        """All optimizers that the policy is trained on."""
        return (self.optimizer, *self.algorithm.also_on)

    @property
    def limits(self) -> SizeLimits:
        """Population sizes that the policy can choose."""
        return SizeLimits(self.min_population_size, self.max_population_size)

    def options(self) -> dict[str, object]:
        """Return all options by name, with the options of the algorithm."""
        algorithm = dataclasses.asdict(self.algorithm)
        shared = {name: getattr(self, name) for name in SHARED}
        return {**shared, "algorithm": algorithm.pop("name"), **algorithm}

    def changed(self, **options: object) -> "TrainConfig":
        """Return this configuration with other values of some options, also of the algorithm.

        Another algorithm takes over the options that both algorithms have, and imitates no controller unless
        both do. Its other options have their defaults.

        Raises:
            UnknownNameError: if there is no such algorithm.
            ValueError: for an option that does not exist, or that the algorithm lacks.
        """
        values: dict[str, Any] = {**options}
        name = values.pop("algorithm", self.algorithm.name)
        kind = look_up("algorithm", name, ALGORITHMS)
        mine = option_names(kind)
        if unknown := sorted(set(values) - {*SHARED, *EVERY_OPTION}):
            raise ValueError(f"unknown options {unknown}")
        refuse_foreign(name, values)
        kept = {option: getattr(self.algorithm, option, None) for option in mine}
        given = {option: value for option, value in {**kept, **values}.items() if value is not None}
        return dataclasses.replace(
            self,
            **{option: value for option, value in values.items() if option in SHARED},
            algorithm=kind(**{option: given[option] for option in mine if option in given}),
        )

    def env_options(self) -> EnvOptions:
        """Return the options of the environments, for training and validation."""
        return {
            **changed_options(self),
            "iterations": self.iterations,
            "min_population_size": self.min_population_size,
            "max_population_size": self.max_population_size,
            "reward": ENV_REWARD if self.reward == PAIRED else self.reward,
            "price": self.price[0] if len(self.price) == 1 else self.price,
            "max_evaluations": self.max_evaluations or None,
        }


def changed_options(config: object) -> EnvOptions:
    """Return encoding, costs and source of a training or a tuning where they are not the defaults.

    Defaults are left out, since each of these options exists on some kinds of scenarios only.
    """
    names = [name for name in _OF_SOME_KINDS if hasattr(config, name)]
    given = {name: getattr(config, name) for name in names}
    return cast(EnvOptions, {n: value for n, value in given.items() if value != getattr(TrainConfig, n)})


# Names of the options that a training has with any algorithm.
SHARED = tuple(field.name for field in dataclasses.fields(TrainConfig) if field.name != "algorithm")


def stored_config(manifest: Mapping[str, object]) -> TrainConfig:
    """Return the training configuration in a policy's manifest.

    An empty manifest, of a controller without one, and an empty `config`, of an imported policy, give the
    defaults.

    Raises:
        ValueError: for an option that does not exist.
        OwnCodeError: for an option that names code, which a file never imports.
    """
    options = cast(Mapping[str, object], manifest["config"]) if manifest else {}
    refuse_own_code(options, "the policy's configuration")
    unknown = sorted(set(options) - {"algorithm", *SHARED, *EVERY_OPTION})
    if unknown:
        raise ValueError(f"the policy's configuration has unknown options {unknown}")
    foreign = foreign_options(str(options.get("algorithm", PPO.name)))
    return TrainConfig().changed(
        **{
            name: tuple(value) if isinstance(value, list) else value
            for name, value in options.items()
            if name not in foreign
        }
    )

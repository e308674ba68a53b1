"""The options of a training run, a dataclass from which the command line is made."""

from collections.abc import Mapping
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

from swarm_gym.controllers import SizeLimits
from swarm_gym.training.own_names import refuse_own_code
from swarm_gym.training.paired_reward import ENV_REWARD, PAIRED


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
    algorithm: str = "ppo"
    """Learning algorithm: ppo, device-ppo, recurrent-ppo, dqn or evolution."""
    device: str = "cpu"
    """Device of the swarms and of the learner's tensors, cpu or cuda; cuda is for device-ppo only."""
    threads: int = 1
    """Number of threads for the swarms. Results do not depend on it; more than one thread slows torch."""
    seed: int = 0
    """Seed of all random numbers of the run."""
    total_steps: int = 640_000
    """Number of environment steps, summed over all swarms; the last chunk is always completed."""
    optimizer: str = "firefly"
    """Optimizer that the policy controls, e.g. firefly or fish-swarm."""
    also_on: tuple[str, ...] = ()
    """Further optimizers that the policy is trained on, each with the same number of swarms; for ppo in
    groups, and for decisions that all of them have, such as size and phi."""
    scenarios: tuple[str, ...] = ("case1", "case2", "case3")
    """Scenarios that episodes draw from, e.g. case1 case2 or random-fields:train:0-511."""
    encoding: str = "waypoints"
    """Meaning of the decision vectors: waypoints, or bezier for control points on grid maps."""
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
    group_size: int = 1
    """Number of swarms that share seed, scenario, price and first state, for ppo and device-ppo only: their
    advantages are relative to the mean of the group. It has to divide num_swarms; 1 is no groups."""
    branches: tuple[int, ...] = ()
    """Iterations, counted from 0, at which the swarms of a group begin to differ; each rollout draws one, and
    before it the policy decides without noise. By default corrected_from."""
    branch_at_events: bool = False
    """After every event on the map, the swarms of a group go on from the state of their first one, in half of
    the rollouts; for ppo only. The group's advantages then are of what is decided after the event."""
    base: str = "none"
    """Controller whose decisions the policy corrects, e.g. open-loop:three-cases; none for no base."""
    corrected_from: int = 0
    """First iteration, counted from 0, in which the policy corrects its base; the base acts alone before."""
    warm_start: str = "spsfa-tip"
    """Controller that the policy imitates before the training; none trains from random weights."""
    hidden_layers: tuple[int, ...] = (64, 64)
    """Sizes of the hidden tanh layers of the policy, and of the critic where there is one."""
    lstm_size: int = 32
    """Number of LSTM units before the hidden layers; for recurrent-ppo only."""
    log_std: float = -1.6
    """Natural logarithm of the initial standard deviation of actions in [-1, 1]."""
    noise_steps: int = 1
    """Number of steps that share the noise of their actions, and the advantage of the first of them; for ppo
    and device-ppo only. The noise is then a random matrix on the last hidden layer (gSDE). 0 holds it for the
    episode, 1 draws noise for every step."""
    critic: bool = True
    """A critic estimates returns; without one, for ppo and device-ppo only, gae_lambda has to be 1."""
    learning_rate: float = 3e-4
    """Step size of Adam."""
    decay_steps: int = 0
    """Number of environment steps over which learning_rate falls linearly to 0, for ppo, device-ppo and
    dqn only; 0 keeps it. It must not be below total_steps, since the steps after it would teach nothing."""
    averaging: float = 0.0
    """Share that an update keeps of the running mean of the actor's weights, which are the policy's, for ppo
    and device-ppo only; 0 takes the last weights."""
    batch_size: int = 640
    """Number of environment steps in a minibatch."""
    epochs: int = 10
    """Number of passes over the steps of a rollout."""
    discount: float = 1.0
    """Discount factor gamma of future rewards; 1 is none."""
    gae_lambda: float = 0.98
    """Parameter lambda of generalised advantage estimation, from 0 to 1."""
    clip_range: float = 0.2
    """Clipping range of PPO's probability ratio, 1 - clip_range to 1 + clip_range."""
    entropy_weight: float = 0.0
    """Weight of the entropy bonus in the loss."""
    target_kl: float = 0.03
    """Kullback-Leibler divergence from the old policy beyond which an update stops early."""
    candidates: int = 16
    """Number of candidates per generation, for evolution only; it has to divide the number of swarms."""
    sigma: float = 0.1
    """Initial step size of the weights, for evolution only."""
    size_choices: tuple[float, ...] = (-0.3, -0.15, 0.0, 0.15, 0.3)
    """Numbers in [-1, 1] that a policy by dqn chooses from for the size; corrections if there is a base."""
    degree_choices: tuple[float, ...] = (-0.4, 0.0, 0.4)
    """Numbers in [-1, 1] that a policy by dqn chooses from for the repair degree, as for the size."""
    replay_size: int = 200_000
    """Number of environment steps that are kept to learn from, for dqn only."""
    return_steps: int = 1
    """Number of steps whose rewards are summed before the network estimates the rest, for dqn only."""
    gradient_steps: int = 4
    """Number of minibatches after each step of all swarms, for dqn only."""
    target_steps: int = 10_000
    """Number of environment steps after which the target network is replaced, for dqn only."""
    exploration_steps: int = 300_000
    """Number of environment steps over which the share of random choices falls to 5 %, for dqn only."""
    rollouts_per_chunk: int = 10
    """Number of rollouts, or generations, per chunk; a chunk ends with validation and a checkpoint."""
    validation_scenarios: tuple[str, ...] = ()
    """Scenarios for validation, where a range counts as one scenario; by default those of the training."""
    validation_seeds: int = 64
    """Number of validation episodes per scenario."""

    @property
    def folder(self) -> Path:
        """Folder of the run."""
        return self.runs / (self.name or f"{self.preset}/{self.seed}")

    @property
    def optimizers(self) -> tuple[str, ...]:
        """All optimizers that the policy is trained on."""
        return (self.optimizer, *self.also_on)

    @property
    def limits(self) -> SizeLimits:
        """Population sizes that the policy can choose."""
        return SizeLimits(self.min_population_size, self.max_population_size)

    def env_options(self) -> dict[str, Any]:
        """Return the options of the environments, for training and validation."""
        # Test functions have no encoding, so the default is left out.
        encoding = {} if self.encoding == TrainConfig.encoding else {"encoding": self.encoding}
        return {
            **encoding,
            "iterations": self.iterations,
            "min_population_size": self.min_population_size,
            "max_population_size": self.max_population_size,
            "reward": ENV_REWARD if self.reward == PAIRED else self.reward,
            "price": self.price[0] if len(self.price) == 1 else self.price,
            "max_evaluations": self.max_evaluations or None,
        }


def stored_config(manifest: Mapping[str, Any]) -> TrainConfig:
    """Return the training configuration in a policy's manifest.

    An empty manifest, of a controller without one, and an empty `config`, of an imported policy, give the
    defaults.

    Raises:
        ValueError: for an option that does not exist.
        OwnCodeError: for an option that names code, which a file never imports.
    """
    options = manifest["config"] if manifest else {}
    refuse_own_code(options, "the policy's configuration")
    unknown = sorted(set(options) - {field.name for field in fields(TrainConfig)})
    if unknown:
        raise ValueError(f"the policy's configuration has unknown options {unknown}")
    values: dict[str, Any] = {
        name: tuple(value) if isinstance(value, list) else value for name, value in options.items()
    }
    return TrainConfig(**values)

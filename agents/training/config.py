"""The options of a training run: one documented dataclass, which is also the command line."""

from collections.abc import Mapping
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

from agents.training.paired_reward import ENV_REWARD, PAIRED
from swarm_gym.controllers import SizeLimits


@dataclass(frozen=True)
class TrainConfig:
    """Options of a training run; all are stored with the policy."""

    preset: str = "three-cases"
    """The preset that the other options come from, where they are not given."""
    name: str = ""
    """The run's folder is <runs>/<name>; <preset>/<seed> by default."""
    runs: Path = Path("runs")
    """Where runs are kept."""
    resume: bool = False
    """Go on with a run of that name that was stopped."""
    algorithm: str = "ppo"
    """What learns, a name in `agents.training.learners.LEARNERS`."""
    threads: int = 1
    """Threads that the swarms are spread over. Results do not depend on it; more than one slows torch."""
    seed: int = 0
    """Seed of everything random in the run."""
    total_steps: int = 640_000
    """Environment steps, over all swarms; the last chunk is finished."""
    optimizer: str = "firefly"
    """The optimizer that is controlled."""
    scenarios: tuple[str, ...] = ("case1", "case2", "case3")
    """Scenarios that episodes draw from."""
    encoding: str = "waypoints"
    """How decision vectors are read; "bezier" on grid maps."""
    iterations: int = 100
    """Length of an episode."""
    num_swarms: int = 64
    """Swarms advanced side by side."""
    initial_population_size: int = 80
    """PS(0)."""
    min_population_size: int = 2
    """Smallest size the policy can ask for."""
    max_population_size: int = 200
    """Largest size the policy can ask for."""
    observation: str = "extended"
    """Observation layout of the policy."""
    action: str = "normalised"
    """Action layout of the policy, scaled to [-1, 1]."""
    max_evaluations: int = 0
    """Evaluation budget of an episode; 0 is no budget."""
    reward: str = "progress"
    """Reward by name; `paired` is the reference's log(final gap) minus one's own, from the same start."""
    reference: str = "spsfa-tip"
    """Controller that a paired reward compares with."""
    price: tuple[float, ...] = (0.17,)
    """What 100,000 evaluations cost, in units of the reward; two are the range that episodes draw from."""
    base: str = "none"
    """Controller whose decisions the policy corrects; 'none' lets it decide alone."""
    corrected_from: int = 0
    """Iteration, counted from 0, from which it corrects them; before, the base decides alone."""
    warm_start: str = "spsfa-tip"
    """Controller to imitate first; 'none' starts from scratch."""
    hidden_layers: tuple[int, ...] = (64, 64)
    """Sizes of the hidden layers, tanh, of actor and critic each."""
    lstm_size: int = 32
    """Size of the memory before these layers, of recurrent PPO."""
    log_std: float = -1.6
    """Logarithm of the initial standard deviation of normalised actions."""
    learning_rate: float = 3e-4
    """Step size of Adam."""
    batch_size: int = 640
    """Samples per gradient step."""
    epochs: int = 10
    """Passes over a rollout."""
    discount: float = 1.0
    """gamma of PPO."""
    gae_lambda: float = 0.98
    """lambda of generalised advantage estimation."""
    clip_range: float = 0.2
    """PPO's clipping of the probability ratio."""
    entropy_weight: float = 0.0
    """Weight of the entropy bonus."""
    target_kl: float = 0.03
    """Stop an update early beyond this divergence."""
    candidates: int = 16
    """Candidates per generation of an evolution strategy; swarms are shared out among them."""
    sigma: float = 0.1
    """Initial step size of an evolution strategy."""
    rollouts_per_chunk: int = 10
    """Rollouts of one episode per swarm (or generations) between two checkpoints with validation."""
    validation_scenarios: tuple[str, ...] = ()
    """Scenarios for validation, a range counting as one; those of the training by default."""
    validation_seeds: int = 64
    """Episodes per scenario for validation."""

    @property
    def folder(self) -> Path:
        """Where this run is kept."""
        return self.runs / (self.name or f"{self.preset}/{self.seed}")

    @property
    def limits(self) -> SizeLimits:
        """Population sizes the policy can ask for."""
        return SizeLimits(self.min_population_size, self.max_population_size)

    def env_options(self) -> dict[str, Any]:
        """Options of the environments, for training and validation."""
        # Of test functions the default says nothing either.
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
    """The configuration that a policy's manifest says it was trained with; defaults where it says nothing.

    Entries that there are no longer are passed over, and numbers that are ranges by now are read as such.
    """
    values: dict[str, Any] = {}
    for field in fields(TrainConfig):
        if field.name in manifest.get("config", {}):
            value = manifest["config"][field.name]
            if isinstance(field.default, tuple) and not isinstance(value, list | tuple):
                value = (value,)
            values[field.name] = tuple(value) if isinstance(value, list) else value
    return TrainConfig(**values)

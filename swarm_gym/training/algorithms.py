"""The options of learning algorithms: a dataclass for each.

To add an algorithm, write its options here, enter them in `ALGORITHMS`, and write its learner, see
`swarm_gym.training.learners`. Command lines, presets and stored configurations follow from the dataclass.
"""

from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Annotated, Literal, get_type_hints

import tyro

from swarm_gym.checks import look_up

_NAMED = tyro.conf.arg(
    name="algorithm",
    metavar="{ppo,choice-ppo,device-ppo,recurrent-ppo,dqn,evolution}",
    help="Learning algorithm. The help lists its options only, e.g. those of dqn for --algorithm dqn --help.",
)


class Algorithm:
    """The options of a learning algorithm.

    The attributes below are no options yet. Each value holds for all algorithms without an option of that
    name, so that environments and checks need not know the algorithm.

    Attributes:
        name: name of the algorithm.
        also_on: further optimizers that the policy is trained on.
        averaging: share that an update keeps of the running mean of the weights.
        branch_at_events: whether groups of swarms begin to differ after an event on the map.
        branches: iterations at which the swarms of a group begin to differ.
        critic: whether a critic estimates returns.
        decay_steps: number of environment steps over which the step size falls; 0 keeps it.
        device: device of swarms and tensors.
        group_size: number of swarms that begin together.
        lstm_size: number of LSTM units; None without an LSTM.
        noise_steps: number of steps that share the noise of their actions.
        rollout_steps: number of steps of a rollout; 0 is an episode.
        warm_start: controller that the policy imitates before the training.
    """

    name: str
    also_on: tuple[str, ...] = ()
    averaging: float = 0.0
    branch_at_events: bool = False
    branches: tuple[int, ...] = ()
    critic: bool = True
    decay_steps: int = 0
    device: str = "cpu"
    group_size: int = 1
    lstm_size: int | None = None
    noise_steps: int = 1
    rollout_steps: int = 0
    warm_start: str = "none"


@dataclass(frozen=True)
class GradientOptions(Algorithm):
    """Options of algorithms that follow gradients."""

    learning_rate: float = 3e-4
    """Step size of Adam."""
    batch_size: int = 640
    """Number of environment steps in a minibatch."""
    discount: float = 1.0
    """Discount factor gamma of future rewards; 1 is none."""


@dataclass(frozen=True)
class ClippedOptions(GradientOptions):
    """Options of all kinds of proximal policy optimization."""

    log_std: float = -1.6
    """Natural logarithm of the initial standard deviation of actions in [-1, 1]."""
    epochs: int = 10
    """Number of passes over the steps of a rollout."""
    gae_lambda: float = 0.98
    """Parameter lambda of generalised advantage estimation, from 0 to 1."""
    clip_range: float = 0.2
    """Clipping range of PPO's probability ratio, 1 - clip_range to 1 + clip_range."""
    entropy_weight: float = 0.0
    """Weight of the entropy bonus in the loss."""
    target_kl: float = 0.03
    """Kullback-Leibler divergence from the old policy beyond which an update stops early."""


@dataclass(frozen=True)
class GroupedOptions(ClippedOptions):
    """Options of proximal policy optimization whose swarms may begin in groups."""

    group_size: int = 1
    """Number of swarms that share seed, scenario, price and first state: their advantages are relative to the
    mean of the group. It has to divide num_swarms; 1 is no groups."""
    branches: tuple[int, ...] = ()
    """Iterations, counted from 0, at which the swarms of a group begin to differ; each rollout draws one, and
    before it the policy decides without noise. By default corrected_from."""
    noise_steps: int = 1
    """Number of steps that share the noise of their actions, and the advantage of the first of them. The
    noise is then a random matrix on the last hidden layer (gSDE). 0 holds it for the episode, 1 draws noise
    for every step."""
    critic: bool = True
    """A critic estimates returns; without one, gae_lambda has to be 1."""
    decay_steps: int = 0
    """Number of environment steps over which learning_rate falls linearly to 0; 0 keeps it. It must not be
    below total_steps, since the steps after it would teach nothing."""
    averaging: float = 0.0
    """Share that an update keeps of the running mean of the actor's weights, which are the policy's; 0 takes
    the last weights."""


@dataclass(frozen=True)
class PPO(GroupedOptions):
    """Options of proximal policy optimization."""

    name: Annotated[Literal["ppo"], _NAMED] = "ppo"
    warm_start: str = "spsfa-tip"
    """Controller that the policy imitates before the training; none trains from random weights."""
    also_on: tuple[str, ...] = ()
    """Further optimizers that the policy is trained on, each with the same number of swarms; in groups, and
    for decisions that all of them have, such as size and phi."""
    rollout_steps: int = 0
    """Number of steps of every swarm in a rollout, e.g. 128 where episodes are long; 0 is an episode. A
    rollout of steps needs group_size 1 and corrected_from 0."""
    branch_at_events: bool = False
    """After every event on the map, the swarms of a group go on from the state of their first one, in half of
    the rollouts. The group's advantages then are of what is decided after the event."""


@dataclass(frozen=True)
class ChoicePPO(ClippedOptions):
    """Options of proximal policy optimization of a policy that chooses from a grid, as DQN does."""

    name: Annotated[Literal["choice-ppo"], _NAMED] = "choice-ppo"
    size_choices: tuple[float, ...] = (-1.0, -0.5, 0.0, 0.5, 1.0)
    """Numbers in [-1, 1] that the policy chooses from for the size."""
    degree_choices: tuple[float, ...] = (0.0,)
    """Numbers in [-1, 1] that the policy chooses from for the repair degree, as for the size."""
    further_choices: tuple[str, ...] = ()
    """Numbers in [-1, 1] that it chooses from for each further decision of the action layout, a text for
    each, e.g. '-1 0 1' '0.5'. All combinations with sizes and degrees can be chosen."""
    rollout_steps: int = 0
    """Number of steps of every swarm in a rollout, e.g. 128 where episodes are long; 0 is an episode."""
    decay_steps: int = 0
    """Number of environment steps over which learning_rate falls linearly to 0; 0 keeps it. It must not be
    below total_steps, since the steps after it would teach nothing."""
    averaging: float = 0.0
    """Share that an update keeps of the running mean of the actor's weights, which are the policy's; 0 takes
    the last weights."""


@dataclass(frozen=True)
class DevicePPO(GroupedOptions):
    """Options of proximal policy optimization on one device."""

    name: Annotated[Literal["device-ppo"], _NAMED] = "device-ppo"
    device: str = "cpu"
    """Device of the swarms and of the learner's tensors, cpu or cuda."""


@dataclass(frozen=True)
class RecurrentPPO(ClippedOptions):
    """Options of proximal policy optimization of an actor with an LSTM."""

    name: Annotated[Literal["recurrent-ppo"], _NAMED] = "recurrent-ppo"
    warm_start: str = "spsfa-tip"
    """Controller that the policy imitates before the training; none trains from random weights."""
    lstm_size: int = 32
    """Number of LSTM units before the hidden layers."""


@dataclass(frozen=True)
class DQN(GradientOptions):
    """Options of deep Q-networks."""

    name: Annotated[Literal["dqn"], _NAMED] = "dqn"
    decay_steps: int = 0
    """Number of environment steps over which learning_rate falls linearly to 0; 0 keeps it. It must not be
    below total_steps, since the steps after it would teach nothing."""
    size_choices: tuple[float, ...] = (-0.3, -0.15, 0.0, 0.15, 0.3)
    """Numbers in [-1, 1] that the policy chooses from for the size; corrections if there is a base."""
    degree_choices: tuple[float, ...] = (-0.4, 0.0, 0.4)
    """Numbers in [-1, 1] that the policy chooses from for the repair degree, as for the size."""
    replay_size: int = 200_000
    """Number of environment steps that are kept to learn from."""
    return_steps: int = 1
    """Number of steps whose rewards are summed before the network estimates the rest."""
    gradient_steps: int = 4
    """Number of minibatches after each step of all swarms."""
    target_steps: int = 10_000
    """Number of environment steps after which the target network is replaced."""
    exploration_steps: int = 300_000
    """Number of environment steps over which the share of random choices falls to 5 %."""


@dataclass(frozen=True)
class Evolution(Algorithm):
    """Options of evolution strategies."""

    name: Annotated[Literal["evolution"], _NAMED] = "evolution"
    candidates: int = 16
    """Number of candidates per generation; it has to divide the number of swarms."""
    sigma: float = 0.1
    """Initial step size of the weights."""
    also_on: tuple[str, ...] = ()
    """Further optimizers that the policy is trained on, each with the same number of swarms; for decisions
    that all of them have, such as size and phi."""


AnyAlgorithm = PPO | ChoicePPO | DevicePPO | RecurrentPPO | DQN | Evolution

ALGORITHMS: dict[str, type[AnyAlgorithm]] = {
    "ppo": PPO,
    "choice-ppo": ChoicePPO,
    "device-ppo": DevicePPO,
    "recurrent-ppo": RecurrentPPO,
    "dqn": DQN,
    "evolution": Evolution,
}


def option_names(algorithm: type[AnyAlgorithm]) -> tuple[str, ...]:
    """Return the names of the options of an algorithm, but for its name."""
    return tuple(field.name for field in fields(algorithm) if field.name != "name")


# Type and default of every option of any algorithm.
EVERY_OPTION: dict[str, tuple[object, object]] = {
    option: (get_type_hints(algorithm)[option], getattr(algorithm, option))
    for algorithm in ALGORITHMS.values()
    for option in option_names(algorithm)
}
# Presets hand these on to presets that are like them, and an algorithm that lacks them ignores them.
_IGNORED = frozenset((*option_names(Evolution), *option_names(RecurrentPPO))) - {"also_on", "warm_start"}


def foreign_options(name: str) -> frozenset[str]:
    """Return the options that the algorithm of a name lacks and others have.

    Raises:
        UnknownNameError: if there is no such algorithm.
    """
    return frozenset(EVERY_OPTION) - set(option_names(look_up("algorithm", name, ALGORITHMS)))


def refuse_foreign(name: str, options: Mapping[str, object]) -> None:
    """Raise an error for options that an algorithm lacks, unless they have no effect.

    Some options have no effect: options of networks, gradients and evolution, which presets hand on to
    presets like them, and any whose value means that it is not used.

    Raises:
        UnknownNameError: if there is no such algorithm.
        ValueError: naming the option and its value.
    """
    for option in sorted(foreign_options(name) & set(options)):
        value = options[option]
        unused = getattr(Algorithm, option, EVERY_OPTION[option][1])
        if option in _IGNORED or value == unused:
            continue
        if option == "warm_start":
            raise ValueError(f"{name} imitates no controller: warm_start must be 'none', got {value!r}")
        having = [other for other, algorithm in ALGORITHMS.items() if option in option_names(algorithm)]
        allowed = " or ".join(map(repr, having))
        raise ValueError(f"{option} {value!r} is for algorithm {allowed} only, got {name!r}")

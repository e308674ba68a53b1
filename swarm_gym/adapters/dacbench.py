"""The environments of this package as a benchmark of DACBench.

Source: T. Eimer et al., "DACBench: a benchmark library for dynamic algorithm configuration", IJCAI 2021. An
instance of DACBench is a scenario here; the seed of an episode comes from the generator of the environment.

    from swarm_gym.adapters.dacbench import SwarmBenchmark

    env = SwarmBenchmark().get_environment()
"""

from dataclasses import dataclass
from typing import Any, ClassVar, TypedDict, cast

import gymnasium
import numpy as np
from numpy.typing import NDArray

from swarm_gym.env import Info, SwarmEnv
from swarm_gym.errors import MissingExtraError, SettingError, shown
from swarm_gym.scenarios import expand_name

try:
    from dacbench import AbstractBenchmark, AbstractEnv
    from dacbench.abstract_benchmark import objdict
except ImportError as error:
    raise MissingExtraError("swarm_gym.adapters.dacbench", "DACBench", "dacbench") from error


@dataclass(frozen=True)
class SwarmInstance:
    """An instance: wrappers of DACBench file results under the attributes of such an object.

    Attributes:
        scenario: name of the scenario.
    """

    scenario: str


class Configuration(TypedDict, total=False):
    """A configuration; `SwarmBenchmark` describes the entries, which may be left out."""

    optimizer: str
    scenarios: list[str]
    test_scenarios: list[str]
    options: dict[str, object]
    cutoff: int
    seed: int
    reward_range: tuple[float, float]
    benchmark_info: dict[str, object]
    instance_set: dict[int, SwarmInstance]
    test_set: dict[int, SwarmInstance]


# What a configuration has unless it says otherwise; plain data, so that DACBench can write it as JSON.
DEFAULTS: Configuration = {
    "optimizer": "firefly",
    "scenarios": ["case1", "case2", "case3"],
    "test_scenarios": ["random-fields:test:0-9"],
    "options": {"num_waypoints": 31},
    "cutoff": 100,
    "seed": 0,
    "reward_range": (-np.inf, np.inf),
    "benchmark_info": {
        "identifier": "swarm_gym",
        "name": "Population size and repair degree of swarm optimizers for path planning",
        "reward": "Logarithm of the progress towards the lower bound, minus the cost of the evaluations",
        "state_description": ["E(P)", "Mean collision", "Standard deviation of the collision", "Iteration"],
        "action_description": ["Size of the next population", "Repair degree phi"],
    },
}
# What differs for the (1 + (lambda, lambda)) genetic algorithm on OneMax.
ONEMAX: "Configuration" = {
    **DEFAULTS,
    "optimizer": "one-plus-lambda-lambda",
    "scenarios": ["onemax:100", "onemax:200", "onemax:500"],
    "test_scenarios": ["onemax:1000", "onemax:2000"],
    "options": {},
    "cutoff": 24_000,
    "reward_range": (-np.inf, 0.0),
    "benchmark_info": {
        "identifier": "swarm_gym-onemax",
        "name": "Population size of the (1 + (lambda, lambda)) genetic algorithm on OneMax",
        "reward": "Minus the evaluations of the iteration, relative to the length of the string",
        "state_description": ["Length of the string", "Number of ones"],
        "action_description": ["Lambda", "Repair degree, which must be 0"],
    },
}
TRAINING, TEST = "scenarios", "test_scenarios"
SETS = ("instance_set", "test_set")  # of training and of test


class SwarmDACEnv(AbstractEnv):
    """A `SwarmEnv` whose scenario is the instance that DACBench has chosen.

    Spaces, rewards and the end of episodes are as in `SwarmEnv`. As in all of DACBench, every episode goes
    on to the next instance, whatever its seed; `reset(options={"instance_id": 0})` chooses one. The `info`
    has only the numbers that `SwarmEnv` reports, since DACBench compares infos as numbers.

    Attributes:
        swarm_env: the environment of the swarm.

    Args:
        config: configuration as `SwarmBenchmark` makes it.

    Raises:
        UnknownNameError: for an option, optimizer or scenario that does not exist.
        SettingError: for a value that an option cannot have.
    """

    def __init__(self, config: "Configuration"):
        options: dict[str, Any] = config["options"]
        instances = [*config["instance_set"].values(), *config.get("test_set", {}).values()]
        self.swarm_env = SwarmEnv(
            config["optimizer"],
            scenario=list(dict.fromkeys(instance.scenario for instance in instances)),
            iterations=int(config["cutoff"]),
            **options,
        )
        spaces = {
            "observation_space": self.swarm_env.observation_space,
            "action_space": self.swarm_env.action_space,
        }
        super().__init__(objdict({**config, **spaces}))

    def reset(
        self, seed: int | None = None, options: dict[str, object] | None = None
    ) -> tuple[NDArray, dict[str, float]]:
        """Go on to the next instance, begin an episode there, and return the first observation and info.

        Args:
            seed: seed of this episode and the following ones; None goes on with the present generator.
            options: `instance`, `instance_id` or `scheme`, as DACBench knows them; others go to `SwarmEnv`.

        Raises:
            SettingError: for `scenario`, which the instance decides, or a number that no instance has.
        """
        ours = dict(options or {})
        if "scenario" in ours:
            raise SettingError(
                f"options of reset: the instance decides the scenario, got {shown(ours['scenario'])}; name "
                "an instance by instance_id"
            )
        if "instance_id" in ours and ours["instance_id"] not in self.instance_set:
            raise SettingError(
                f"options of reset: instance_id must be one of {shown(list(self.instance_set))}, got "
                f"{shown(ours['instance_id'])}"
            )
        theirs = {name: ours.pop(name) for name in ("instance", "instance_id", "scheme") if name in ours}
        self.reset_(seed, theirs)
        drawn = int(self.np_random.integers(2**31))
        observation, info = self.swarm_env.reset(
            seed=drawn, options={**ours, "scenario": self.instance.scenario}
        )
        return observation, _numbers(info)

    def step(self, action: NDArray) -> tuple[NDArray, float, bool, bool, dict[str, float]]:
        """Advance the swarm by one iteration; an action has the layout of the option `action`."""
        self.step_()
        observation, reward, terminated, truncated, info = self.swarm_env.step(action)
        return observation, reward, terminated, truncated, _numbers(info)

    def close(self) -> None:
        """Close the environment."""
        self.swarm_env.close()


class SwarmBenchmark(AbstractBenchmark):
    """The benchmark: population size and repair degree of a swarm optimizer, on a set of scenarios.

    The configuration has these entries besides the ones of DACBench:

    | entry | value |
    |---|---|
    | `optimizer` | a name in `swarm_gym.optimizers.OPTIMIZERS`, or one of own code |
    | `scenarios` | names or ranges of the training instances, all of one kind |
    | `test_scenarios` | names or ranges of the test instances |
    | `options` | options of `swarm_gym.settings.Settings`, and parameters of the optimizer |
    | `cutoff` | iterations of an episode |

    Args:
        config_path: JSON file with a configuration; what it leaves out is as in `defaults`.
        config: a configuration.

    Raises:
        SettingError: for a configuration without scenarios.
    """

    config: objdict
    defaults: ClassVar["Configuration"] = DEFAULTS

    def __init__(self, config_path: str | None = None, config: "Configuration | None" = None):
        for names in (TRAINING, TEST):
            if config is not None and config.get(names) == []:
                raise SettingError(f"{names} must name at least one scenario, got none")
        super().__init__(config_path, None if config is None else objdict(config))
        given = self.config or {}
        self.config = objdict({**self.defaults, **given})
        for names in (TRAINING, TEST):  # DACBench makes arrays of lists that it reads
            self.config[names] = [str(name) for name in self.config[names]]
        self.config["options"] = dict(self.config["options"])
        for name in SETS:  # DACBench saves instances that were made as texts; they are made again
            if not all(isinstance(one, SwarmInstance) for one in self.config.get(name, {}).values()):
                del self.config[name]

    def read_instance_set(self, test: bool = False) -> None:
        """Make the numbered instances of the names of scenarios in the configuration."""
        names = self.config[TEST if test else TRAINING]
        expanded = [SwarmInstance(one) for name in names for one in expand_name(name)]
        self.config[SETS[test]] = dict(enumerate(expanded))

    def get_environment(self) -> gymnasium.Env[NDArray, NDArray]:
        """Return the environment of the configuration, in the wrappers that are registered."""
        for test, name in enumerate(SETS):
            if name not in self.config:
                self.read_instance_set(bool(test))
        env: gymnasium.Env[NDArray, NDArray] = SwarmDACEnv(self.config)
        for wrap in self.wrap_funcs:
            env = wrap(env)
        return env

    def get_benchmark(self, seed: int = 0) -> gymnasium.Env[NDArray, NDArray]:
        """Return the environment of the default configuration and this seed."""
        self.config = objdict({**self.defaults, "seed": seed})
        return self.get_environment()


class OneMaxBenchmark(SwarmBenchmark):
    """The benchmark whose optimum is known: lambda of the (1 + (lambda, lambda)) genetic algorithm on OneMax.

    Its configuration has the entries of `SwarmBenchmark`, with the values of `ONEMAX` where it states none.
    """

    defaults: ClassVar["Configuration"] = ONEMAX


def _numbers(info: Info) -> dict[str, float]:
    given = cast(dict[str, float | str | NDArray], info)
    return {name: value for name, value in given.items() if not isinstance(value, str | np.ndarray)}

"""The options of environments: one dataclass for single and vector environments.

`swarm_gym.worlds` makes the problems that they describe.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, fields, replace
from functools import cached_property
from typing import Any

from swarm_gym.checks import look_up, require_integer, require_number
from swarm_gym.errors import SettingError, UnknownNameError, shown
from swarm_gym.kinds import ENCODINGS, PROBLEM_OPTIONS, Kind, kind_of
from swarm_gym.optimizers.optimizer import Optimizer
from swarm_gym.scenarios import AnyScenario, make_scenarios, worlds_of
from swarm_gym.sources import AMPLITUDES, GUIDED, MIXED, SMOOTH, SOURCES, UNIFORM, Source, kind_of_bends


@dataclass(frozen=True)
class Settings:
    """The options of an environment; lengths are in map units.

    The SPSFA paper defines letters such as mu, g_max and E(P), see `swarm_gym.scenarios.papers.spsfa`.

    Attributes:
        scenario: name of a scenario, a scenario, or a list of these; a name with a range of numbers stands
            for all of them. Each episode draws one of the scenarios by its seed. All must be of one kind.
        encoding: how decision vectors are read: "waypoints"; on grid maps also "bezier"; or "walk", as points
            that a walk over free cells has reached; over terrain also "shifted", as waypoints that move along
            the line, too, and "spherical", as steps with a climb and a heading. The default is the first of
            `Optimizer.encodings`. Test functions take vectors as they are.
        num_waypoints: n, number of waypoints of a path, at least 1. Over terrain it is at least 4, or 6 with
            the encoding "shifted", and 10 where nothing else is asked for.
        num_control_points: number of control points of a Bezier curve, without start and target, at least 1.
        length_weight: mu in (0, 1], weight of the length in the fitness on analytic maps.
        penalty: lambda, at least 0: the fitness that each of about 1000 equal parts of a path costs on grid
            maps if it is blocked, or each cell's length of the blocked part of a walk.
        distance_weight: weight, from 0 on, of the cost of nearness to blocked cells along a path; on grid
            maps only, for waypoints and Bezier curves, see `swarm_gym.problem.grid.nearness`.
        ground_weight: weight, from 0 on, of the costs of ground along a path; likewise, on scenarios that
            have such costs, see `swarm_gym.scenarios.graded_map`.
        curvature_weight: weight, from 0 on, in map units squared, of the integral of the squared curvature of
            a path; likewise, see `swarm_gym.problem.grid.cost`.
        cell_size: side of the cells that analytic maps are converted to for walks.
        cost: cost of flights over terrain: "documented", measured exactly, or "metabox", as published code
            computes it, see `swarm_gym.problem.terrain.cost`.
        clearance: distance that paths keep from obstacles, in map units, at least 0: the obstacles of all
            maps grow by it, for cost, repair, exact checks and optima alike, see
            `swarm_gym.scenarios.growing`. Not for robots that drive.
        iterations: g_max, number of steps of an episode, at least 1.
        initial_population_size: PS(0), size of the first population, within the two limits below.
        min_population_size: smallest population size that an action can ask for.
        max_population_size: largest population size that an action can ask for; memory grows with it.
        source: source of new members: "uniform", as in the papers, "smooth", "mixed" or "guided"; see
            `swarm_gym.sources`. Points of a walk and vectors of test functions can only be uniform. Where a
            robot drives, they cannot be guided.
        smooth_share: probability in [0, 1] that a new member is smooth; for the source "mixed" only.
        amplitude: largest offset of smooth members as a share of the workspace's width, in [0.01, 1]; None is
            0.5, and 0.05 for the source "guided".
        bends: kind of smooth members, a name in `swarm_gym.problem.geometry.bends.BENDS`.
        mean_weight: k in [0, 1] of E(P) = k mean + (1 - k) std.
        action: layout of actions, a name in `swarm_gym.action.ACTIONS`.
        observation: layout of observations, a name in `swarm_gym.observation.OBSERVATIONS`, or several joined
            by `+`.
        reward: a name in `swarm_gym.reward.REWARDS`.
        price: cost of `reference_evaluations` evaluations, in units of the reward, at least 0; or (low,
            high), both positive: then each episode draws the price by its seed, uniformly in the logarithm.
        reference_evaluations: number of evaluations that `price` refers to, at least 1.
        max_evaluations: evaluation budget of an episode, which ends when it is spent; None is no budget.
        final_repair: whether the best path is made free at the end of an episode, for `info`; on maps only.
            See `swarm_gym.final_repair`. Nothing that the optimizer does or finds changes with it.
        made_for: optimizer that the controller of these episodes was made for; None is any. Another optimizer
            is refused if its decisions differ, and `info` names this one if they agree.
        knobs: parameters of the optimizer by name, where they differ from its defaults; this field has the
            name that stored configurations have for it.

    Raises:
        UnknownNameError: for an encoding that does not exist.
        SettingError: for a value that an option cannot have.
    """

    scenario: str | AnyScenario | tuple[str | AnyScenario, ...] = "case1"
    encoding: str = "waypoints"
    num_waypoints: int = 31
    num_control_points: int = 4
    length_weight: float = 0.3
    penalty: float = 500.0
    distance_weight: float = 0.0
    ground_weight: float = 0.0
    curvature_weight: float = 0.0
    cell_size: float = 2.0
    cost: str = "documented"
    clearance: float = 0.0
    iterations: int = 100
    initial_population_size: int = 80
    min_population_size: int = 2
    max_population_size: int = 200
    source: str = "uniform"
    smooth_share: float = 0.5
    amplitude: float | None = None
    bends: str = "harmonics"
    mean_weight: float = 0.1
    action: str = "natural"
    observation: str = "paper"
    reward: str = "progress"
    price: float | tuple[float, float] = 0.5
    reference_evaluations: int = 100_000
    max_evaluations: int | None = None
    final_repair: bool = False
    made_for: str | None = None
    knobs: Mapping[str, float | str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        look_up("encoding", self.encoding, dict.fromkeys(ENCODINGS))
        require_integer("iterations", self.iterations, 1)
        require_integer("min_population_size", self.min_population_size, 1)
        require_integer("max_population_size", self.max_population_size, self.min_population_size)
        self.check_population_size("initial_population_size", self.initial_population_size)
        require_integer("reference_evaluations", self.reference_evaluations, 1)
        require_number("mean_weight", self.mean_weight, 0.0, 1.0)
        require_number("clearance", self.clearance, 0.0, 1e9)
        look_up("source", self.source, dict.fromkeys(SOURCES))
        Source(self.smooth_share, self._amplitude)
        kind_of_bends(self.bends)
        self._check_price()
        if not isinstance(self.final_repair, bool):
            raise SettingError(f"final_repair must be True or False, got {shown(self.final_repair)}")
        if self.max_evaluations is not None:
            require_integer("max_evaluations", self.max_evaluations, self.initial_population_size)

    @classmethod
    def from_options(cls, optimizer: type[Optimizer], options: Mapping[str, object]) -> "Settings":
        """Return settings from keyword options; parameters of the optimizer are options like the others.

        Raises:
            UnknownNameError: for an option that does not exist.
            SettingError: for a value that an option cannot have, or an option that would change nothing.
        """
        own = {f.name for f in fields(cls)} - {"knobs"}
        for name in options:
            if name not in own and name not in optimizer.parameters:
                valid = own | set(optimizer.parameters)
                raise UnknownNameError("option", name, valid, "swarm_gym.settings.Settings")
        values: dict[str, Any] = {name: value for name, value in options.items() if name in own}
        values = {**optimizer.default_options, **values}
        if values.setdefault("encoding", optimizer.encodings[0]) not in optimizer.encodings:
            raise UnknownNameError(f"encoding of {optimizer.name}", values["encoding"], optimizer.encodings)
        scenario = values.get("scenario", cls.scenario)
        if isinstance(scenario, Iterable) and not isinstance(scenario, str):
            values["scenario"] = tuple(scenario)
        knobs: dict[str, Any] = {name: options[name] for name in options if name in optimizer.parameters}
        optimizer.parameter_values(knobs)
        settings = cls(**values, knobs=knobs)
        defaults: dict[str, Any] = {
            name: value for name, value in settings.kind.defaults if name not in values
        }
        settings = replace(settings, **defaults) if defaults else settings
        require_integer("min_population_size", settings.min_population_size, optimizer.smallest_population)
        settings.refuse_unused(options)
        settings._refuse_compiled(optimizer)
        return settings

    @cached_property
    def scenarios(self) -> tuple[AnyScenario, ...]:
        """The scenarios that episodes draw from.

        Raises:
            SettingError: if the list of scenarios is empty.
        """
        given = self.scenario if isinstance(self.scenario, tuple) else (self.scenario,)
        scenarios = tuple(scenario for name in given for scenario in make_scenarios(name))
        if not scenarios:
            raise SettingError("scenario: expected at least one scenario, got an empty list")
        return scenarios

    @cached_property
    def kind(self) -> Kind:
        """The kind of the first scenario; `worlds.problems_for` refuses scenarios of several kinds."""
        return kind_of(worlds_of(self.scenarios[0])[0].scenario)

    @property
    def new_members(self) -> Source:
        """The source of new members, where no action decides it."""
        share = {UNIFORM: 0.0, SMOOTH: 1.0, MIXED: self.smooth_share, GUIDED: 1.0}[self.source]
        return Source(share, self._amplitude)

    @property
    def _amplitude(self) -> float:
        return AMPLITUDES[self.source] if self.amplitude is None else self.amplitude

    @property
    def decides_sources(self) -> bool:
        """True if actions decide the source of new members."""
        return isinstance(self.action, str) and self.action.startswith("sourced")

    def require_sources(self, asked: str) -> None:
        """Raise an error if new members can only be uniform here.

        Args:
            asked: option or action that needs other sources, for the message.

        Raises:
            SettingError: if decision vectors are not whole paths.
        """
        if self.encoding in self.kind.sourced or self.encoding not in self.kind.options:
            return  # an encoding that this kind of scenario does not have is refused when problems are made
        vectors = "points of a walk" if self.encoding == "walk" else f"vectors of {self.kind.name}"
        raise SettingError(
            f"{asked}: smooth new members are whole paths, but here members are {vectors}; the only source "
            f"is {UNIFORM!r}"
        )

    def refuse_unused(self, given: Iterable[str]) -> None:
        """Raise an error if an option has no effect on this kind of scenario, encoding or source."""
        if self.source != UNIFORM:
            self.require_sources(f"source {self.source!r}")
        unused = set() if self.source == MIXED else {"smooth_share"}
        if self.source == UNIFORM and not self.decides_sources:
            unused |= {"amplitude", "bends"}
        for name in sorted(unused & set(given)):
            others = [MIXED] if name == "smooth_share" else [SMOOTH, MIXED, GUIDED]
            raise SettingError(
                f"option {name!r} has no effect with source {self.source!r}; remove it, or choose source "
                f"{' or '.join(map(repr, others))}"
            )
        for name in (name for name in given if name in PROBLEM_OPTIONS):
            if not any(name in options for options in self.kind.options.values()):
                raise SettingError(f"option {name!r} has no effect on {self.kind.name}; remove it")
            if name not in self.kind.options.get(self.encoding, (name,)):
                raise SettingError(
                    f"option {name!r} has no effect with encoding {self.encoding!r}; remove it"
                )

    def _refuse_compiled(self, optimizer: type[Optimizer]) -> None:
        """Raise an error if Python code evaluates the scenario, and the optimizer is compiled."""
        name, kind = self.scenarios[0].name, self.kind
        if kind.calls_python and not getattr(optimizer, "calls_python", False):
            raise SettingError(
                f"scenario {name!r}: optimizer {optimizer.name!r} is compiled and cannot call "
                f"{kind.name}, which Python evaluates; choose an optimizer of swarm_gym.adapters, such as "
                f"swarm_gym.adapters.pymoo:ParticleSwarm, or a function that is compiled, too, such as "
                f"function:bbob-8-5-1"
            )

    def _check_price(self) -> None:
        if not isinstance(self.price, tuple | list):
            require_number("price", self.price, 0.0, 1e9)
            return
        if len(self.price) != 2:
            raise SettingError(f"price must be a number or (low, high), got {self.price!r}")
        object.__setattr__(self, "price", tuple(self.price))
        for bound in self.price:
            require_number("price", bound, 1e-9, 1e9)
        if self.price[0] >= self.price[1]:
            raise SettingError(f"price: (low, high) needs low < high, got {self.price!r}")

    def check_population_size(self, name: str, value: object) -> None:
        """Raise an error if a value is not a population size within the limits.

        Raises:
            SettingError: if it is not.
        """
        require_integer(name, value, self.min_population_size, self.max_population_size)

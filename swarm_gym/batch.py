"""A batch of swarms as a decision process: actions in; observations, rewards and infos out.

Both environments are thin shells around `SwarmBatch`, so that one swarm and many go through the same
arithmetic.
"""

from collections.abc import Mapping

import numpy as np
from gymnasium.spaces import Box
from numpy.typing import NDArray

from swarm_gym.action import make_action
from swarm_gym.arrays import Constant, as_numpy, copy_of
from swarm_gym.errors import ActionError, SettingError, StepOrderError
from swarm_gym.final_repair import final_repair
from swarm_gym.history import COLUMN
from swarm_gym.object_arrays import ObjectArray
from swarm_gym.observation import make_observation
from swarm_gym.optimizers import get_optimizer
from swarm_gym.population import FEASIBLE_SHARE
from swarm_gym.problem import MapProblem, OneMaxProblem
from swarm_gym.problem.analytic.cost import FEASIBILITY_TOLERANCE
from swarm_gym.problem.geometry.clearance import clearance_of
from swarm_gym.problem.geometry.polylines import length_of
from swarm_gym.reward import (
    COUNT_EVALUATIONS,
    NEED_A_BUDGET,
    NEED_AN_OPTIMUM,
    NEED_BITS,
    NEED_ROBOTS,
    NEED_WEIGHTS,
    REWARDS,
    RewardCheck,
    Transition,
    budget_shares,
    make_reward,
    offline_weight,
)
from swarm_gym.robots import require_drives
from swarm_gym.settings import Settings
from swarm_gym.simulation import Decisions, Simulation

# Entries of info that a swarm does not always have.
SOMETIMES = (
    "optimality_gap", "feasible_path", "feasible_fitness", "feasible_length", "feasible_clearance",
    "repaired_path", "repaired_length", "repair_evaluations",
)  # fmt: skip

Flags = NDArray[np.bool_]
Floats = NDArray[np.float64]


class SwarmBatch:
    """A batch of B swarms behind the action, observation and reward that the settings name.

    Args:
        optimizer: name of the optimizer.
        options: options of `Settings` and parameters of the optimizer, by name.
        num_swarms: number of swarms B.
        num_threads: number of threads that the swarms are spread over; None takes all that Numba has.
        simulation_class: class of the simulation, which says where its arrays are.
        arrival_window: number of iterations whose new members are recorded, at least those that the
            observation needs.

    Attributes:
        settings: options of the environment.
        simulation: the swarms themselves.
        action_space: space of one swarm's action.
        observation_space: space of one swarm's observation.
    """

    def __init__(
        self,
        optimizer: str,
        options: Mapping[str, object],
        num_swarms: int,
        num_threads: int | None = None,
        simulation_class: type[Simulation] = Simulation,
        arrival_window: int = 0,
    ):
        optimizer_class = get_optimizer(optimizer)
        self._optimizer = optimizer
        self.settings = Settings.from_options(optimizer_class, options)
        self._action = make_action(self.settings, optimizer_class)
        self._observation = make_observation(self.settings.observation)
        self._reward = make_reward(self.settings.reward)
        self._measures = self.settings.reward not in COUNT_EVALUATIONS
        self._weighs = self.settings.reward in NEED_WEIGHTS or self.settings.reward not in REWARDS
        self._reward_check = None if self.settings.reward in REWARDS else RewardCheck(self.settings.reward)
        recorded = max(arrival_window, self._observation.arrival_window)
        self.simulation = simulation_class(optimizer_class, self.settings, num_swarms, num_threads, recorded)
        self._nothing = self.simulation.full(0.0)  # what a reward does not read
        if self.settings.reward in NEED_AN_OPTIMUM:
            self.simulation.worlds.require_optima(f"reward {self.settings.reward!r}")
        if self.settings.reward in NEED_BITS + NEED_AN_OPTIMUM:
            self._require_kind_of_reward()
        if self.settings.reward in NEED_ROBOTS:
            require_drives(self.settings.scenarios, f"reward {self.settings.reward!r}")
        if self.settings.reward in NEED_A_BUDGET and self.settings.max_evaluations is None:
            raise SettingError(
                f"reward {self.settings.reward!r} averages over a budget of evaluations, which is not set; "
                "set max_evaluations, or choose another reward"
            )
        names = [problem.scenario.name for problem in self.simulation.problems]
        self._scenario_names = np.array(names, dtype=object).view(ObjectArray)
        self.action_space: Box = self._action.space
        self.observation_space: Box = self._observation.space(self.simulation)
        self._low, self._high = Constant(self.observation_space.low), Constant(self.observation_space.high)

    def reset(
        self,
        chosen: Flags,
        seeds: NDArray[np.uint32],
        options: Mapping[str, object] | None,
    ) -> None:
        """Begin episodes in the chosen swarms.

        Args:
            chosen: (B,) swarms that begin an episode.
            seeds: (k, 8) one seed per chosen swarm, see `swarm_gym.episode_seeds`.
            options: options of `reset`, see `Simulation.reset`.
        """
        self.simulation.reset(chosen, seeds, options)

    def step(self, chosen: Flags, actions: object) -> tuple[Floats, Flags]:
        """Advance the chosen swarms by one iteration.

        Args:
            chosen: (B,) swarms to advance, an array of the simulation's library, as the results are.
            actions: (B, number of decisions); only the chosen rows have to be valid.

        Returns:
            Rewards (B,), 0 where a swarm is not chosen, and whether the episodes ended (B,).

        Raises:
            ActionError: for an action that is not in the action space.
            StepOrderError: if no episode of a chosen swarm is under way.
            OwnCodeError: for a reward of own code that is no array of B finite numbers.
        """
        simulation = self.simulation
        xp = simulation.xp
        try:
            numbers, valid = self._action.read(actions, simulation)
        except ActionError:
            self._refuse_idle(chosen)
            raise
        refused = chosen & ~(valid & simulation.running)
        if refused.any():  # one question for both reasons, since the answer waits for a GPU
            self._refuse_idle(chosen)
            self._action.refuse(numbers, refused)
        decisions = self._decide(numbers, chosen)
        evaluations = copy_of(xp, simulation.swarms.evaluations)
        gap_before = simulation.gaps.now() if self._measures else simulation.gaps.initial
        gap_after = simulation.step(chosen, decisions, self._measures)
        ended = chosen & ~simulation.running
        spent = simulation.swarms.evaluations - evaluations
        reward = self._reward(
            Transition(
                initial_gap=simulation.gaps.initial,
                gap_before=gap_before,
                gap_after=gap_after,
                cost=simulation.prices.cost(spent) if self._measures else self._nothing,
                ended=ended,
                offline_weight=offline_weight(simulation) if self._weighs else self._nothing,
                optimality_gap=simulation.gaps.optimality,
                detour=simulation.detours,
                evaluations=spent,
                lengths=simulation.lengths,
                budget_shares=lambda: budget_shares(simulation, spent, ended),
                xp=xp,
            )
        )
        if self._reward_check is None:
            return xp.where(chosen, reward, 0.0), ended
        self._reward_check.check_shape(reward, simulation.num_swarms)
        paid = xp.where(chosen, reward, 0.0)
        self._reward_check.check_numbers(paid, simulation.iteration, xp)
        return paid, ended

    def _decide(self, numbers: Floats, chosen: Flags) -> Decisions:
        """Return the decisions that numbers of actions, (B, k), ask for in the chosen swarms, (B,)."""
        return self._action.decide(numbers, chosen, self.simulation)

    def _require_kind_of_reward(self) -> None:
        """Raise an error if the reward counts what the scenarios do not have.

        Raises:
            SettingError: naming the reward and the first scenario.
        """
        reward, problem = self.settings.reward, self.simulation.problems[0]
        if (reward in NEED_BITS) is not isinstance(problem, OneMaxProblem):
            expected = (
                "a bit string, such as onemax:100" if reward in NEED_BITS else "a map or a test function"
            )
            raise SettingError(
                f"reward {reward!r} needs {expected}, got scenario {problem.scenario.name!r}; choose another "
                f"reward or scenario"
            )

    def _refuse_idle(self, chosen: NDArray[np.bool_]) -> None:
        """Raise an error if any of these swarms, (B,), is to take a step although no episode is under way.

        Raises:
            StepOrderError: naming the first one, and whether there was an episode before.
        """
        waiting = np.flatnonzero(as_numpy(chosen & ~self.simulation.running))
        if waiting.size:
            started = as_numpy(self.simulation.swarms.size)[waiting] > 0
            reason = "the episode has ended" if started.all() else "there was no reset yet"
            raise StepOrderError(f"step of swarm {waiting[0]}: {reason}; call reset() first") from None

    def observe(self) -> NDArray:
        """Return the observations of all swarms, (B, k), a new array."""
        simulation = self.simulation
        xp, device = simulation.xp, simulation.device
        found = self._observation.observe(simulation)
        return xp.minimum(xp.maximum(found, self._low.on(xp, device)), self._high.on(xp, device))

    def observe_last(self) -> NDArray:
        """Return the observations (B, k) of episodes that have just ended, before new ones begin."""
        return self.observe()

    def copy_rows(self, rows: NDArray[np.int64]) -> None:
        """Make swarm i, for every i, a copy of swarm rows[i]."""
        self.simulation.copy_rows(rows)

    def numbers(self) -> dict[str, NDArray]:
        """Return the infos on all swarms that are plain numbers of the state: new arrays (B,).

        These are arrays of the simulation's library; nothing waits for a GPU.
        """
        simulation, swarms, xp = self.simulation, self.simulation.swarms, self.simulation.xp
        return {
            "best_fitness": copy_of(xp, swarms.best_fitness),
            "best_collision": copy_of(xp, swarms.best_collision),
            "feasible": swarms.best_collision <= FEASIBILITY_TOLERANCE,
            "feasible_fitness": simulation.paths.feasible_fitness(),
            "evaluations": copy_of(xp, swarms.evaluations),
            "population_size": copy_of(xp, swarms.size),
            "feasible_share": copy_of(xp, swarms.summary[:, FEASIBLE_SHARE]),
            "repair_degree": simulation.history[simulation.rows, simulation.iteration, COLUMN.repair_degree],
            **{name: copy_of(xp, each) for name, each in simulation.optimizer.counts(swarms).items()},
        }

    def info(self, rows: NDArray[np.bool_] | None = None) -> dict[str, NDArray]:
        """Return infos on all swarms: new NumPy arrays whose first axis has length B.

        What takes long, the measures of paths and their final repair, is computed for the swarms of the (B,)
        flags `rows` only; None is all.

        `robot`, (B, 2), and `driven`, (B,), are there if robots drive. Entries in `SOMETIMES` are NaN for
        swarms that do not have them: `optimality_gap` where the optimum is unknown or the episode goes on.
        Those that only ended episodes have are left out if none of the asked swarms has one.
        Call `numbers` instead where copies from a GPU would take too long.
        """
        simulation, robots = self.simulation, self.simulation.robots
        where = {} if robots is None else {"robot": robots.places.copy(), "driven": robots.driven.copy()}
        ended = ~as_numpy(simulation.running)
        asked = ended if rows is None else ended & rows
        repaired = self._repaired(asked) if self.settings.final_repair else {}
        numbers = {name: as_numpy(values) for name, values in self.numbers().items()}
        feasible_paths = simulation.paths.feasible(numbers["feasible_fitness"])
        return {
            **numbers,
            "best_path": simulation.paths.best(),
            "feasible_path": feasible_paths,
            "scenario": self._scenario_names[as_numpy(simulation.swarms.problem)],
            **self._made_for(),
            **where,
            **self._measured(feasible_paths, asked),
            **repaired,
            **self._final_gaps(asked),
        }

    def _made_for(self) -> dict[str, NDArray]:
        """Return the optimizer that the controller was made for, if that is another one."""
        made_for = self.settings.made_for
        if made_for is None or made_for == self._optimizer:
            return {}
        return {"made_for": np.full(self.simulation.num_swarms, made_for, dtype=object).view(ObjectArray)}

    def _measured(self, paths: NDArray, ended: NDArray[np.bool_]) -> dict[str, NDArray]:
        """Return length and clearance of the best feasible paths of these swarms, (B,), else NaN.

        There are none on problems without a map, or if no episode has ended.
        """
        simulation = self.simulation
        rows = np.flatnonzero(ended)
        if not (rows.size and isinstance(simulation.problems[0], MapProblem)):
            return {}
        lengths, clearances = np.full((2, simulation.num_swarms), np.nan)
        for row in rows[is_there(paths[rows])].tolist():
            problem = simulation.problem_of(row)
            assert isinstance(problem, MapProblem)
            lengths[row] = length_of(paths[row])
            clearances[row] = clearance_of(problem.scenario, paths[row])
        return {"feasible_length": lengths, "feasible_clearance": clearances}

    def _final_gaps(self, ended: NDArray[np.bool_]) -> dict[str, NDArray]:
        """Return the optimality gaps of these swarms, (B,), else NaN; none if no episode has ended."""
        if not ended.any():
            return {}
        return {"optimality_gap": np.where(ended, as_numpy(self.simulation.gaps.optimality()), np.nan)}

    def _repaired(self, ended: NDArray[np.bool_]) -> dict[str, NDArray]:
        """Return the final repairs of the best paths of these swarms, (B,); NaN where none was found."""
        simulation = self.simulation
        paths = np.full_like(simulation.paths.best(), np.nan)
        lengths, evaluations = np.full((2, len(paths)), np.nan)
        for row in np.flatnonzero(ended & (as_numpy(simulation.swarms.size) > 0)).tolist():
            problem = simulation.problem_of(row)
            assert isinstance(problem, MapProblem)
            found = final_repair(problem, simulation.paths.best_of(row))
            if found is not None and len(found.path) <= paths.shape[1]:
                paths[row] = found.path[-1]
                paths[row, : len(found.path)] = found.path
                lengths[row], evaluations[row] = found.length, found.evaluations
        return {"repaired_path": paths, "repaired_length": lengths, "repair_evaluations": evaluations}


def is_there(values: NDArray) -> NDArray[np.bool_]:
    """Return (B,) which swarms have an entry in `SOMETIMES`, by its values of all swarms."""
    return ~np.isnan(values.reshape(len(values), -1)[:, 0])

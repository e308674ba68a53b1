"""One swarm as a Gymnasium environment."""

from typing import Any

import gymnasium
import numpy as np
from numpy.typing import NDArray

from swarm_gym.batch import SwarmBatch
from swarm_gym.checks import refuse_negative_seed, require_integer
from swarm_gym.errors import UnknownNameError
from swarm_gym.rendering import DESIGN, HEIGHTS, WIDTHS, Renderer, Scene

ALL = np.ones(1, dtype=np.bool_)
RENDER_MODES = ("human", "rgb_array")


class SwarmEnv(gymnasium.Env[NDArray, NDArray]):
    """A swarm optimizer on a path-planning scenario, or on a test function; one step is one iteration.

    Between two iterations a controller sees how badly the population collides, and decides how large the
    next population is and how strongly infeasible paths are repaired.

    | action (`natural`, float64) | from | to |
    |---|---|---|
    | next population size, rounded to nearest | min_population_size | max_population_size |
    | repair degree phi; 0 is no repair | 0 | 1 |
    | with `extended`: each of the optimizer's parameters that has a range `Parameter.decided` | low | high |

    The layouts `normalised` and `extended-normalised` ask for the same in [-1, 1], float32: sizes and
    parameters in the logarithm. In `paced` and `extended-paced` the size is relative to the one at which
    `max_evaluations` would just last.

    | observation (`paper`, float64) | from | to |
    |---|---|---|
    | population collision E(P) = k mean + (1 - k) std, map units | 0 | a bound of the scenario |
    | mean degree of collision, map units | 0 | same |
    | standard deviation of the degree of collision, map units | 0 | same |
    | iteration | 0 | iterations |

    Other layouts, scaled for networks, are in `swarm_gym.observation`; `paper+rich` is one after the other.

    Reward (`progress`): log(gap before / gap after) - price * evaluations / reference_evaluations, with
    gap = best fitness so far - its lower bound: mu * straight line, on grid maps the straight line.

    On test functions nothing collides: E(P) is 0 throughout, all members are feasible, and the repair degree
    changes nothing. The lower bound is 0, and so is the optimum; see docs/scenarios.md.

    The episode is terminated after `iterations` steps, or when `max_evaluations` are spent. `reset` evaluates
    the first population: its E(P) is the first observation. Its seed fixes scenario and trajectory; its
    options are `scenario`, `initial_population_size` and `initial_population`.

    `info`: best_fitness, best_collision, best_path (k, 2), evaluations, population_size, feasible_share,
    repair_degree, scenario; where robots drive, robot (2,), the place, and driven, the length; and at the end
    optimality_gap, where the optimum is known. On a test function the path is the vector in parallel
    coordinates.

    Args:
        optimizer: a name in `swarm_gym.optimizers.OPTIMIZERS`.
        render_mode: None, "human" (a window, whose keys its title says) or "rgb_array".
        render_width: of frames, in pixels, within `swarm_gym.rendering.WIDTHS`.
        render_height: likewise, within `swarm_gym.rendering.HEIGHTS`.
        options: see `swarm_gym.settings.Settings`, and the parameters of the optimizer.
    """

    metadata = {"render_modes": list(RENDER_MODES), "render_fps": 20}  # noqa: RUF012

    def __init__(
        self,
        optimizer: str = "firefly",
        *,
        render_mode: str | None = None,
        render_width: int = DESIGN[0],
        render_height: int = DESIGN[1],
        **options: Any,
    ):
        if render_mode is not None and render_mode not in RENDER_MODES:
            raise UnknownNameError("render mode", render_mode, RENDER_MODES)
        require_integer("render_width", render_width, *WIDTHS)
        require_integer("render_height", render_height, *HEIGHTS)
        self.render_mode = render_mode
        self.render_width, self.render_height = int(render_width), int(render_height)
        self._batch = SwarmBatch(optimizer, options, num_swarms=1)
        self._renderer: Renderer | None = None
        self.action_space = self._batch.action_space
        self.observation_space = self._batch.observation_space

    @property
    def settings(self) -> Any:
        """The `Settings` of this environment."""
        return self._batch.settings

    @property
    def simulation(self) -> Any:
        """The `Simulation` inside, a batch of one: population, history, problem."""
        return self._batch.simulation

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[NDArray, dict[str, Any]]:
        """Begin an episode; see the class for the options.

        Raises:
            UnknownNameError: for an option or scenario that is not there.
            SettingError: for a value that an option cannot have.
            gymnasium.error.Error: for a seed that is no natural number.
        """
        self._batch.simulation.read_options(options)  # before anything is drawn
        refuse_negative_seed(seed)
        super().reset(seed=seed)
        self._batch.reset(ALL, [self.np_random], options)
        self._show()
        return self._batch.observe()[0], self._info()

    def step(self, action: NDArray) -> tuple[NDArray, float, bool, bool, dict[str, Any]]:
        """Resize the population, advance it by one iteration with this repair degree.

        Raises:
            ActionError: if the action is not in the action space.
            StepOrderError: before the first `reset` and after the end of an episode.
        """
        reward, ended = self._batch.step(ALL, _as_batch(action))
        self._show()
        return self._batch.observe()[0], float(reward[0]), bool(ended[0]), False, self._info()

    def render(self) -> NDArray[np.uint8] | None:
        """The current frame, (render_height, render_width, 3), in mode "rgb_array".

        In mode "human" `reset` and `step` show each picture; here the window only reacts to its user.
        """
        if self.render_mode == "human":
            self._get_renderer().respond()
        if self.render_mode != "rgb_array":
            return None
        return self._get_renderer().frame(Scene.of(self._batch.simulation))

    def close(self) -> None:
        """Close the window, if there is one."""
        if self._renderer is not None:
            self._renderer.close()
            self._renderer = None

    def _show(self) -> None:
        if self.render_mode == "human":
            self._get_renderer().show(Scene.of(self._batch.simulation))

    def _get_renderer(self) -> Renderer:
        if self._renderer is None:
            self._renderer = Renderer(self.render_width, self.render_height, fps=self.metadata["render_fps"])
        return self._renderer

    def _info(self) -> dict[str, Any]:
        info = {name: values[0] for name, values in self._batch.info().items()}
        if np.isnan(info["optimality_gap"]):
            del info["optimality_gap"]
        return info

    def __getstate__(self) -> dict[str, Any]:
        # A window stays where it was opened; the copy opens its own.
        return {**self.__dict__, "_renderer": None}


def _as_batch(action: object) -> object:
    try:
        return np.asarray(action)[None]
    except Exception:  # which the check of actions meets again, and reports
        return action

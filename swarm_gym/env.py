"""The environment of a single swarm, for `gymnasium.make`."""

from typing import Any, TypedDict, cast

import gymnasium
import numpy as np
from numpy.typing import NDArray

from swarm_gym.batch import SOMETIMES, is_there
from swarm_gym.checks import refuse_negative_seed, require_integer
from swarm_gym.controllers import Controller
from swarm_gym.corrected_batch import CorrectedBatch, make_batch
from swarm_gym.episode_seeds import draw_seeds
from swarm_gym.errors import UnknownNameError
from swarm_gym.rendering import DESIGN, HEIGHTS, WIDTHS, Renderer, Scene
from swarm_gym.settings import Settings
from swarm_gym.simulation import Simulation

ALL = np.ones(1, dtype=np.bool_)
RENDER_MODES = ("human", "rgb_array")


class Info(TypedDict, total=False):
    """The entries of `info`, as `SwarmEnv` describes them; some are not always there."""

    best_fitness: float
    best_collision: float
    feasible: bool
    best_path: NDArray[np.float64]
    feasible_path: NDArray[np.float64]
    feasible_fitness: float
    feasible_length: float
    feasible_clearance: float
    evaluations: np.int64
    population_size: np.int64
    feasible_share: float
    repair_degree: float
    scenario: str
    made_for: str
    robot: NDArray[np.float64]
    driven: float
    repaired_path: NDArray[np.float64]
    repaired_length: float
    repair_evaluations: float
    optimality_gap: float


class SwarmEnv(gymnasium.Env[NDArray, NDArray]):
    """A swarm optimizer on a path-planning scenario or a test function; one step is one iteration.

    Between two iterations a controller observes how strongly the paths of the population collide with
    obstacles. It decides the size of the next population, and how strongly infeasible paths are repaired.

        env = gymnasium.make("swarm_gym/Firefly-v0", scenario="case1", iterations=100)
        observation, info = env.reset(seed=0)
        observation, reward, terminated, truncated, info = env.step(np.array([60.0, 0.5]))

    **Action**, layout `natural`: float64, shape (2,); the layouts `extended` and `sourced` have more numbers.

    | number | from | to |
    |---|---|---|
    | size of the next population, rounded to an integer | min_population_size | max_population_size |
    | repair degree phi; 0 is no repair | 0 | 1 |
    | layout `extended`: each parameter of the optimizer that may change at every iteration | low | high |
    | layout `sourced`: those, then smooth share, amplitude and immigrants (see `swarm_gym.action`) | 0 | 1 |

    Other layouts have numbers in [-1, 1], float32, for networks; see `swarm_gym.action`. With the option
    `base`, they are corrections of a controller's decisions, and zeros are that controller, bit for bit.

    **Observation**, layout `paper`: float64, shape (4,), the numbers that the schedule of the SPSFA paper
    uses; E(P) is its eq. 7.

    | number | from | to |
    |---|---|---|
    | population collision E(P) = k mean + (1 - k) std, map units; k is `mean_weight` | 0 | bound of the map |
    | mean degree of collision of the members, map units | 0 | bound of the map |
    | standard deviation of the degree of collision, map units | 0 | bound of the map |
    | iteration | 0 | iterations |

    Other layouts are scaled to float32 for networks; `paper+rich` joins two of them. See
    `swarm_gym.observation`.

    **Reward**, `progress`: log(gap before / gap after) - price * evaluations / reference_evaluations. The gap
    is the best fitness so far minus a lower bound; the evaluations are counted in this step. See
    `swarm_gym.reward`.

    **Episode**: `reset` evaluates the first population; its E(P) is the first observation. The seed
    determines the scenario and all random numbers. Options of `reset` are `scenario`,
    `initial_population_size`, `smooth_share` and `amplitude` of the first population, and
    `initial_population`. The episode terminates after `iterations` steps, or
    when `max_evaluations` are spent; it is never truncated.

    **Info**:

    | key | value |
    |---|---|
    | `best_fitness` | best fitness so far; smaller is better |
    | `best_collision` | degree of collision of the best path so far, map units |
    | `feasible` | whether that path is free, exactly |
    | `best_path` | best path so far, (k, 2), map units |
    | `feasible_path` | if there is one: best feasible path since the map last changed, (k, 2), map units |
    | `feasible_fitness` | fitness of that path, there with it |
    | `feasible_length`, `feasible_clearance` | at the end: its length and its clearance, map units |
    | `evaluations` | evaluations in this episode |
    | `population_size` | size of the population |
    | `feasible_share` | fraction of the members that do not collide |
    | `repair_degree` | repair degree of the last iteration; 0 after `reset` |
    | `scenario` | name of the scenario |
    | `made_for` | optimizer that the controller was made for, if that is another one |
    | `robot`, `driven` | if the robot drives: its position (2,) and the length of its drives, map units |
    | `repaired_path` | with `final_repair`, at the end: a free path near the best one, (k, 2), map units |
    | `repaired_length`, `repair_evaluations` | length of that path, map units; what the repair cost |
    | `optimality_gap` | at the end, where the optimum is quickly found: (best fitness - optimum) / optimum |

    **Test functions**: nothing collides, so E(P) is always 0, all members are feasible, and the repair degree
    changes nothing. The optimum and the lower bound are 0, and `optimality_gap` is the best fitness.
    `best_path` is the decision vector in parallel coordinates. See docs/scenarios-functions.md.

    Args:
        optimizer: a name in `swarm_gym.optimizers.OPTIMIZERS`.
        base: controller, or name of one such as "open-loop:three-cases", whose decisions actions correct, see
            `swarm_gym.corrected_batch`; None for actions that are decisions.
        render_mode: None, "human" (a window, whose title explains its keys) or "rgb_array".
        render_width: width of rendered frames in pixels, within `swarm_gym.rendering.WIDTHS`.
        render_height: height of rendered frames in pixels, within `swarm_gym.rendering.HEIGHTS`.
        options: options of `swarm_gym.settings.Settings` and parameters of the optimizer, by name.

    Raises:
        UnknownNameError: for an option, optimizer, scenario, layout or reward that does not exist.
        SettingError: for a value that an option cannot have.
        ScenarioError: for the name of a scenario that is malformed, or whose map is missing.
    """

    metadata = {"render_modes": list(RENDER_MODES), "render_fps": 20}  # noqa: RUF012

    def __init__(
        self,
        optimizer: str = "firefly",
        *,
        base: str | Controller | None = None,
        render_mode: str | None = None,
        render_width: int = DESIGN[0],
        render_height: int = DESIGN[1],
        **options: object,
    ):
        if render_mode is not None and render_mode not in RENDER_MODES:
            raise UnknownNameError("render mode", render_mode, RENDER_MODES)
        require_integer("render_width", render_width, *WIDTHS)
        require_integer("render_height", render_height, *HEIGHTS)
        self.render_mode = render_mode
        self.render_width, self.render_height = int(render_width), int(render_height)
        self._batch = make_batch(base, optimizer, options, num_swarms=1)
        self._renderer: Renderer | None = None
        self.action_space = self._batch.action_space
        self.observation_space = self._batch.observation_space

    @property
    def settings(self) -> Settings:
        """The `Settings` of this environment."""
        return self._batch.settings

    @property
    def simulation(self) -> Simulation:
        """The `Simulation` in this environment, a batch of one swarm: `swarms`, `history` and `problems`."""
        return self._batch.simulation

    # Gymnasium has plain dictionaries for infos.
    def reset(  # type: ignore[override]
        self, *, seed: int | None = None, options: dict[str, object] | None = None
    ) -> tuple[NDArray, Info]:
        """Begin an episode and return the first observation and info.

        Args:
            seed: natural number that determines the scenario and all random numbers of this episode and the
                following ones; None goes on with the present random generator.
            options: `scenario`, the name of one of this environment's scenarios; `initial_population_size`,
                `smooth_share` and `amplitude`; or `initial_population`, decision vectors, shape
                (members, dimension), in map units.

        Raises:
            UnknownNameError: for an option or scenario that does not exist.
            SettingError: for a value that an option cannot have.
            gymnasium.error.Error: for a seed that is not a natural number.
        """
        self._batch.simulation.read_options(options)  # raises errors before a random number is drawn
        refuse_negative_seed(seed)
        super().reset(seed=seed)
        if isinstance(self._batch, CorrectedBatch):
            self._batch.reset_base(seed)
        self._batch.reset(ALL, draw_seeds(self.np_random, 1), options)
        self._show()
        return self._batch.observe()[0], self._info()

    def step(  # type: ignore[override]
        self, action: NDArray
    ) -> tuple[NDArray, float, bool, bool, Info]:
        """Resize the population and advance it by one iteration with this repair degree.

        Args:
            action: numbers in the layout of the option `action`, shape (number of decisions,).

        Returns:
            Observation, reward, whether the episode has terminated, False for truncated, and info.

        Raises:
            ActionError: if the action is not in the action space.
            StepOrderError: before the first `reset`, or after the end of an episode.
        """
        reward, ended = self._batch.step(ALL, _as_batch(action))
        self._show()
        return self._batch.observe()[0], float(reward[0]), bool(ended[0]), False, self._info()

    def render(self) -> NDArray[np.uint8] | None:
        """Return the current frame, (render_height, render_width, 3) uint8, in mode "rgb_array"; else None.

        In mode "human", `reset` and `step` show each frame; here the window only reacts to its user.
        """
        if self.render_mode == "human":
            self._get_renderer().respond()
        if self.render_mode != "rgb_array":
            return None
        return self._get_renderer().frame(Scene.of(self._batch.simulation))

    def close(self) -> None:
        """Close the window if it is open."""
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

    def _info(self) -> Info:
        info: dict[str, Any] = {name: values[0] for name, values in self._batch.info().items()}
        # Of NumPy's bool, Gymnasium's vectors would make an array of objects.
        info["feasible"] = bool(info["feasible"])
        for name in SOMETIMES:
            if name in info and not is_there(info[name][None])[0]:
                del info[name]
        return cast(Info, info)

    def __getstate__(self) -> dict[str, object]:
        # A copy opens its own window.
        return {**self.__dict__, "_renderer": None}


def _as_batch(action: object) -> object:
    try:
        return np.asarray(action)[None]
    except Exception:  # the check of actions raises it again, and reports it
        return action

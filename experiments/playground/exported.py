"""The values that the playground's JavaScript reads: problems, parameters and controllers, as JSON.

Everything comes from the objects that Python itself runs with, so that the port has no numbers of its own.
The assets `problem.js`, `firefly.js`, `schedule.js` and `policy.js` read these values.
"""

import base64
import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from swarm_gym.compiler.simd import NUM_LANES
from swarm_gym.controllers import make_controller
from swarm_gym.controllers.learned.manifest import FEEDFORWARD
from swarm_gym.controllers.learned.networks import FeedforwardController
from swarm_gym.controllers.learned.policy_file import load_policy, resolve
from swarm_gym.controllers.names import ControllerName
from swarm_gym.controllers.open_loop import OpenLoop
from swarm_gym.controllers.schedules import SelfAdaptiveSchedule
from swarm_gym.env import SwarmEnv
from swarm_gym.errors import SettingError
from swarm_gym.observation import make_observation
from swarm_gym.optimizers.firefly import Firefly
from swarm_gym.problem import AnalyticProblem
from swarm_gym.problem.analytic.table import CIRCLE_ROWS, CORNER_ROWS, PRESENCE, WaypointTable
from swarm_gym.scenarios import Circle, Scenario, make_scenario

SCHEDULE = "spsfa-tip"
POLICY = "learned:three-cases/0@1"
# Options of an environment that the port knows.
PORTED_OPTIONS = ("iterations", "num_waypoints", "length_weight", "mean_weight", *Firefly.parameters)


def export(scenarios: Sequence[str], options: Mapping[str, Any], policy_name: str = POLICY) -> dict[str, Any]:
    """Return the maps, parameters and controllers of a playground.

    Args:
        scenarios: names of fixed maps of circles and polygons whose optimum is known or quickly computed.
        options: options of an environment, out of `PORTED_OPTIONS`.
        policy_name: name of a learned controller that corrects an open loop of size and phi.

    Raises:
        SettingError: for an option, a scenario or a controller that the port lacks.
    """
    if others := sorted(set(options) - set(PORTED_OPTIONS)):
        raise SettingError(
            f"playground: expected options out of {', '.join(PORTED_OPTIONS)}; got {', '.join(others)}"
        )
    if not scenarios:
        raise SettingError("playground: expected at least one scenario, got none")
    policy, schedule = make_controller(policy_name), make_controller(SCHEDULE)
    assert isinstance(schedule, SelfAdaptiveSchedule)
    described = _policy(policy_name, policy)
    environments = [SwarmEnv(scenario=name, **{**options, **policy.env_options()}) for name in scenarios]
    settings, parameters = environments[0].settings, environments[0].simulation.parameters[0]
    return {
        "cases": [_case(env, len(described["features"])) for env in environments],
        "settings": {
            "iterations": settings.iterations,
            "meanWeight": settings.mean_weight,
            "referenceEvaluations": settings.reference_evaluations,
            **dict(zip(Firefly.parameters, parameters.tolist(), strict=True)),
        },
        "sizes": [settings.min_population_size, settings.max_population_size],
        "schedule": _schedule(schedule),
        "policy": described,
    }


def is_ported(scenario: str, options: Mapping[str, Any]) -> bool:
    """Return whether a scenario is a fixed map of circles and polygons whose optimum is known or quick.

    Args:
        scenario: name of any scenario.
        options: options of its environment.
    """
    if not isinstance(make_scenario(scenario), Scenario):
        return False
    worlds = SwarmEnv(scenario=scenario, **options).simulation.worlds
    worlds.compute_optima()
    return not math.isnan(worlds.optima[0])


def _case(env: SwarmEnv, num_features: int) -> dict[str, Any]:
    """Return a problem, and the bounds of the policy's features on it, which are the last of the space."""
    worlds = env.simulation.worlds
    space: Any = env.observation_space
    problem = worlds.problems[0]
    name = problem.scenario.name
    if not isinstance(problem, AnalyticProblem) or len(worlds.problems) > 1:
        raise SettingError(f"playground: expected fixed maps of circles and polygons, got scenario {name!r}")
    worlds.compute_optima()
    optimum = float(worlds.optima[0])
    if math.isnan(optimum):
        raise SettingError(f"playground: the optimum of scenario {name!r} is not known nor quickly computed")
    bounds = np.stack([space.low, space.high], axis=1)
    return {
        "name": name,
        "optimum": optimum,
        "lowerBound": problem.lower_bound,
        "bounds": bounds[-num_features:].tolist(),
        "map": _map(problem.scenario),
        "line": problem.line.tolist(),
        "across": problem.axes.across.tolist(),
        **_table(problem.table),
    }


def _table(table: WaypointTable) -> dict[str, Any]:
    """Return a problem table, with the obstacles over each segment in the order in which kernels add them."""
    return {
        "spacing": table.spacing,
        "lengthWeight": table.length_weight,
        "lower": table.lower.tolist(),
        "upper": table.upper.tolist(),
        "initialLower": table.initial_lower.tolist(),
        "initialUpper": table.initial_upper.tolist(),
        "squaredSpacing": table.squared_spacing.tolist(),
        "segments": [_obstacles_over(table, segment) for segment in range(len(table.squared_spacing))],
    }


def _obstacles_over(table: WaypointTable, segment: int) -> list[dict[str, Any]]:
    """Return the obstacles over a segment: how many corners they have, 0 for circles, and their numbers."""
    block, lane = divmod(segment, NUM_LANES)
    found = []
    for tile in range(table.first_tile[block], table.first_tile[block + 1]):
        first, corners = int(table.first_row[tile]), int(table.num_corners[tile])
        column = table.rows[first : first + (corners * CORNER_ROWS or CIRCLE_ROWS), lane]
        if column[PRESENCE] == -math.inf:
            continue
        if corners:  # corners of a tile that this polygon lacks are infinitely far away
            column = column.reshape(-1, CORNER_ROWS)
            column = column[np.isfinite(column).all(axis=1)]
            corners = len(column)
        found.append({"corners": corners, "numbers": column.ravel().tolist()})
    return found


def _map(scenario: Scenario) -> dict[str, Any]:
    """Return what is drawn of a map, in map units."""
    circles = [o for o in scenario.obstacles if isinstance(o, Circle)]
    return {
        "view": list(scenario.view),
        "circles": [[circle.x, circle.y, circle.radius] for circle in circles],
        "polygons": [list(map(list, o.vertices)) for o in scenario.obstacles if not isinstance(o, Circle)],
        "start": list(scenario.start),
        "target": list(scenario.target),
    }


def _schedule(schedule: SelfAdaptiveSchedule) -> dict[str, Any]:
    limits = schedule.limits
    return {
        "name": schedule.name,
        "firstSize": schedule.initial_population_size,
        "growth": schedule.growth,
        "decay": schedule.decay,
        "lowDeviation": schedule.low_deviation,
        "repairFactor": schedule.repair_factor,
        "smallest": limits.smallest if schedule.smallest is None else schedule.smallest,
        "largest": limits.largest,
    }


def _policy(name: str, policy: Any) -> dict[str, Any]:
    """Return a policy: its features, the decisions of its open loop, and its layers in base 64.

    Raises:
        SettingError: for a controller of another kind.
    """
    kind = (getattr(policy, "network", None), getattr(policy, "action", None))
    loop = getattr(policy, "corrects", None)
    if not (
        isinstance(policy, FeedforwardController)
        and kind == (FEEDFORWARD, "normalised")
        and isinstance(loop, OpenLoop)
        and policy.max_evaluations is None
        and policy.first_source is None
        and policy.needed_limits is not None
    ):
        raise SettingError(
            f"playground: expected a feedforward policy with the action 'normalised' that corrects an open "
            f"loop, without budget or source of its own; got {name!r}"
        )
    manifest, limits = policy.manifest, policy.needed_limits
    weights, _ = load_policy(resolve(ControllerName.parse(name).without_price.argument))
    return {
        "name": name,
        "price": policy.price,
        "firstSize": policy.initial_population_size,
        "smallest": limits.smallest,
        "largest": limits.largest,
        "correctedFrom": manifest["corrected_from"],
        "features": [one.name for one in make_observation(manifest["observation"]).features],
        "openLoop": loop.decisions.tolist(),
        "layers": [  # four bytes for a number, the lowest byte first
            {
                kind: base64.b64encode(weights[f"{layer}.{kind}"].astype("<f4").tobytes()).decode()
                for kind in ("weight", "bias")
            }
            for layer in range(len(manifest["hidden_layers"]) + 1)
        ],
    }

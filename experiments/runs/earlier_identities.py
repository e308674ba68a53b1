"""Results databases of earlier versions: what they hold of a controller becomes its identity from content.

Earlier versions stored the decisions that an open loop had computed. Their last digits depend on the
processor, so the same loop was another controller on another machine.
"""

import dataclasses
import json
import sqlite3
from typing import Any, NamedTuple

from agents import CONTROLLERS, Controller
from experiments.runs.configuration import identity
from experiments.runs.entries import FROM_CONTENT, IDENTITIES, KEY, is_aside
from experiments.runs.episode import controller_of
from swarm_gym.comparing.entrants import entrant
from swarm_gym.controllers.controller import SizeLimits
from swarm_gym.controllers.distilled import DistilledRule
from swarm_gym.controllers.learned.networks import FeedforwardController
from swarm_gym.controllers.names import BLINDED, ControllerName
from swarm_gym.controllers.open_loop import OpenLoop
from swarm_gym.controllers.reacting_loop import ReactingLoop
from swarm_gym.controllers.tuned import load_tuned
from swarm_gym.own_code import origin_of

TOLERANCE = 1e-9  # relative; processors differ by less than 1e-14


class CarriedOver(NamedTuple):
    """The entries of a database that were carried over, and those that were left.

    Attributes:
        carried: names of the controllers whose runs go on.
        left: names of those that are missing or have changed, with the reason. Their runs stay; a suite that
            has a controller of such a name keeps them aside and makes new ones.
    """

    carried: list[str]
    left: dict[str, str]


def carry_over(connection: sqlite3.Connection) -> CarriedOver:
    """Replace what a database holds of its controllers; runs are not touched.

    Args:
        connection: database, in a transaction.
    """
    stored = dict(connection.execute("SELECT key, value FROM configuration"))
    found = CarriedOver([], {})
    if IDENTITIES in stored:
        return found
    optimizer = json.loads(stored.get("optimizer", '"firefly"')).partition(",")[0]
    for key, value in stored.items():
        name = key.removeprefix(KEY)
        if not key.startswith(KEY) or is_aside(name):
            continue
        try:
            controller_name = entrant(name, optimizer).controller
            controller = controller_of(controller_name)
            earlier = json.loads(json.dumps(_earlier_identity(controller_name, controller)))
        except (ValueError, OSError) as error:
            found.left[name] = str(error)
            continue
        if not _is_equal(json.loads(value), earlier):
            found.left[name] = "it has changed since its runs"
            continue
        new = json.dumps(identity(controller_name, controller), sort_keys=True)
        connection.execute("UPDATE configuration SET value = ? WHERE key = ?", (new, key))
        found.carried.append(name)
    connection.execute("INSERT INTO configuration VALUES (?, ?)", (IDENTITIES, json.dumps(FROM_CONTENT)))
    return found


def _earlier_identity(name: str, controller: Controller) -> Any:
    """Return what earlier versions stored of a controller."""
    parts = ControllerName.parse(name)
    found: Any = name
    loop = controller.loop if isinstance(controller, ReactingLoop) else controller
    if parts.family not in CONTROLLERS and parts.family != BLINDED:
        found = name, origin_of("controller", name)
    elif parts.family == BLINDED:
        policy = f"learned:{parts.argument}"
        found = BLINDED, _earlier_identity(policy, controller_of(policy))
    elif parts.family == "tuned":
        tuned = load_tuned(parts.argument)
        sizes = dataclasses.astuple(tuned.limits)
        found = tuned.controller if tuned.limits == SizeLimits() else (tuned.controller, sizes)
    elif isinstance(controller, FeedforwardController):
        found, base = controller.manifest["weights_sha256"], controller.manifest["base"]
        if base != "none":
            corrected = _earlier_identity(base, controller_of(base))
            found = found, controller.manifest["corrected_from"], corrected
    elif isinstance(loop, OpenLoop):
        first = loop.first_source
        source = () if first is None else (dataclasses.astuple(first),)
        found = loop.initial_population_size, loop.decisions.tolist(), *source
    elif isinstance(controller, DistilledRule):
        found = controller.lines()
    return found


def _is_equal(stored: Any, earlier: Any) -> bool:
    """Return whether two values of JSON are equal, numbers but for rounding."""
    if isinstance(stored, list) and isinstance(earlier, list):
        return len(stored) == len(earlier) and all(map(_is_equal, stored, earlier))
    if isinstance(stored, float) and isinstance(earlier, float):
        return abs(stored - earlier) <= TOLERANCE * abs(earlier)
    return bool(stored == earlier)

"""The table of origins of fitted controllers, from the manifests in their files."""

import json
from collections.abc import Mapping, Sequence
from typing import Any

from agents import make_controller
from experiments.runs.groups import group_controllers
from experiments.runs.labels import label
from experiments.tables.cell import MISSING, Entry, interval_cell, number
from experiments.tables.table import Table
from swarm_gym.controllers.distilled import DISTILLED
from swarm_gym.controllers.names import ControllerName
from swarm_gym.controllers.open_loop import OPEN_LOOPS
from swarm_gym.controllers.packaged import find_json
from swarm_gym.controllers.tuned import TUNED

FILES = {"distilled": DISTILLED, "open-loop": OPEN_LOOPS, "reacting-loop": OPEN_LOOPS, "tuned": TUNED}


def origins_table(controllers: Sequence[str]) -> Table:
    """Return a row for each group of packaged controllers: how, on which scenarios and for how long fitted.

    Raises:
        ValueError: if a file is missing, or does not state its origin.
    """
    rows: list[tuple[Entry, ...]] = []
    for group, members in group_controllers(controllers).items():
        try:
            manifests = [_manifest(member) for member in members]
            cells = _cells(manifests[0])
        except KeyError as error:
            raise ValueError(f"the file of {group} does not say its {error}") from error
        rows.append((label(group), *cells, number(len(members), "d")))
    return Table(
        "origins",
        "Fitted controllers",
        ("controller", "how", "begins with", "scenarios", "price", "environment steps", "seeds"),
        rows,
    )


def _manifest(controller: str) -> Mapping[str, Any]:
    name = ControllerName.parse(controller)
    if name.family in FILES:
        path = find_json("controller", name.argument, FILES[name.family], ValueError)
        return json.loads(path.read_text(encoding="utf-8"))["manifest"]
    return make_controller(controller).manifest  # type: ignore[attr-defined]


def _cells(manifest: Mapping[str, Any]) -> tuple[Entry, ...]:
    config = manifest["config"]
    if "policy" in manifest:  # fitted to the decisions of a policy, whose steps and scenarios count
        return f"distilled from {label(manifest['policy'])}", *[MISSING] * 4
    how = f"tuned: {config['what']}" if "what" in config else f"trained: {config['algorithm']}"
    steps = number(config["total_steps"], ",")
    return how, _beginning(config), ", ".join(config["scenarios"]), _price(config["price"]), steps


def _price(price: Any) -> Entry:
    """Return a cell with a price, or with the range of prices of a policy that observes its price."""
    ends = price if isinstance(price, list | tuple) else [price]
    return number(ends[0], "g") if len(ends) == 1 else interval_cell((ends[0], ends[1]), "g")


def _beginning(config: Mapping[str, Any]) -> str:
    """Return the controller that is corrected or imitated, or at whose knots the search starts."""
    if config.get("base", "none") != "none":
        return f"corrects {label(config['base'])}"
    if config.get("start", "none") != "none":
        return f"starts at {label(config['start'])}"
    start = config.get("warm_start", "none")
    return MISSING if start == "none" else f"imitates {label(start)}"

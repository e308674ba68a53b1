"""Where controllers that were fitted come from: what is stored in their files."""

import json
from collections.abc import Mapping, Sequence
from typing import Any

from agents import make_controller
from experiments.runs.groups import group_controllers
from experiments.runs.labels import label
from experiments.tables.table import Table
from swarm_gym.controllers.distilled import DISTILLED
from swarm_gym.controllers.names import ControllerName
from swarm_gym.controllers.open_loop import OPEN_LOOPS
from swarm_gym.controllers.tuned import TUNED

FOLDERS = {"distilled": DISTILLED, "open-loop": OPEN_LOOPS, "tuned": TUNED}
NOT_FITTED = "–"


def origins_table(controllers: Sequence[str]) -> Table:
    """A row for each group of shipped controllers that were fitted: how, on what, and for how long.

    Raises:
        OSError: if a file is missing.
        ValueError: if one says nothing of where it comes from.
    """
    rows = []
    for group, members in group_controllers(controllers).items():
        try:
            manifests = [_manifest(member) for member in members]
            cells = _cells(manifests[0])
        except KeyError as error:
            raise ValueError(f"the file of {group} does not say its {error}") from error
        rows.append((label(group), *cells, str(len(members))))
    return Table(
        "origins",
        "Fitted controllers",
        ("controller", "how", "begins with", "scenarios", "price", "environment steps", "seeds"),
        rows,
    )


def _manifest(controller: str) -> Mapping[str, Any]:
    name = ControllerName.parse(controller)
    if name.family in FOLDERS:
        path = FOLDERS[name.family] / f"{name.argument}.json"
        return json.loads(path.read_text(encoding="utf-8"))["manifest"]
    return make_controller(controller).manifest  # type: ignore[attr-defined]


def _cells(manifest: Mapping[str, Any]) -> tuple[str, ...]:
    config = manifest["config"]
    if "policy" in manifest:  # fitted to what a policy does, of which steps and scenarios are
        return f"distilled from {label(manifest['policy'])}", *[NOT_FITTED] * 4
    how = f"tuned: {config['what']}" if "what" in config else f"trained: {config['algorithm']}"
    price = config["price"]  # of a policy that sees it, the range
    prices = " to ".join(f"{end:g}" for end in price) if isinstance(price, list | tuple) else f"{price:g}"
    return how, _beginning(config), ", ".join(config["scenarios"]), prices, f"{config['total_steps']:,}"


def _beginning(config: Mapping[str, Any]) -> str:
    """The controller that is corrected or imitated."""
    if config.get("base", "none") != "none":
        return f"corrects {label(config['base'])}"
    start = config.get("warm_start", "none")
    return NOT_FITTED if start == "none" else f"imitates {label(start)}"

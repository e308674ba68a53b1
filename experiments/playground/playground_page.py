"""The playground as parts of a page, and as a page of its own that needs no other file and no network."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup

import swarm_gym
from experiments.playground.exported import PORTED_OPTIONS, export, is_ported
from experiments.runs.labels import label
from swarm_gym.optimizers.firefly import Firefly

ASSETS = Path(__file__).parent / "assets"
# The port of Python's code, and then the page; each script uses those before it.
ENGINE = ("random.js", "problem.js", "firefly.js", "schedule.js", "policy.js")
SCRIPTS = (*ENGINE, "drawing.js", "page.js")
CASES = ("case1", "case2", "case3")


@dataclass(frozen=True)
class Playground:
    """The parts of a page with a playground.

    Attributes:
        css: style sheet, whose rules are about the section only.
        section: section with a heading of the second level, and the data.
        script: script that begins the playground; it goes behind the section.
    """

    css: Markup
    section: Markup
    script: Markup


def make_playground(scenarios: Sequence[str] = CASES, options: Mapping[str, Any] | None = None) -> Playground:
    """Return a playground on maps of circles and polygons.

    Args:
        scenarios: names of the maps, see `export`.
        options: options of an environment, out of `PORTED_OPTIONS`.

    Raises:
        SettingError: for an option or a scenario that the port lacks.
    """
    data = export(scenarios, options or {})
    for key, name in (("schedule", data["schedule"]["name"]), ("policy", data["policy"]["name"])):
        data[key]["label"] = label(name)
    section = (
        templates(ASSETS)
        .get_template("section.html.jinja")
        .render(
            cases=[case["name"] for case in data["cases"]],
            sizes=data["sizes"],
            first_size=data["schedule"]["firstSize"],
            schedule=data["schedule"]["label"],
            policy=data["policy"]["label"],
            data=json_for_html(data),
        )
    )
    return Playground(Markup(_read("playground.css")), Markup(section), Markup(_script(SCRIPTS)))


def playground_for(scenarios: Sequence[str], optimizer: str, options: Mapping[str, Any]) -> Playground | None:
    """Return a playground on those of some scenarios that the port can run on; None if there are none.

    Args:
        scenarios: names of scenarios of any kind.
        optimizer: name of the optimizer of the runs.
        options: options of the environments of the runs.
    """
    if optimizer != Firefly.name or not set(options) <= set(PORTED_OPTIONS):
        return None
    ported = [name for name in scenarios if is_ported(name, options)]
    return make_playground(ported, options) if ported else None


def playground_page(scenarios: Sequence[str] = CASES) -> str:
    """Return a playground as an HTML file of its own.

    Raises:
        SettingError: for a scenario that the port lacks.
    """
    template = templates(ASSETS).get_template("page.html.jinja")
    return template.render(playground=make_playground(scenarios), version=swarm_gym.__version__)


def engine() -> str:
    """Return the port as a script whose classes are global, for comparisons with Python."""
    return "\n".join(map(_read, ENGINE))


def _script(names: Sequence[str]) -> str:
    """Return scripts as one, whose names do not meet those of the page around it."""
    return '(() => {\n"use strict";\n' + "\n".join(map(_read, names)) + "})();\n"


def _read(name: str) -> str:
    return (ASSETS / name).read_text(encoding="utf-8")


def json_for_html(value: Any) -> str:
    """Return JSON in which no HTML parser finds the end of a script."""
    return json.dumps(value, separators=(",", ":"), allow_nan=False).replace("<", "\\u003c")


@cache
def templates(folder: Path) -> Environment:
    """Return the templates of a folder, in which every name must be given and texts are escaped."""
    return Environment(
        loader=FileSystemLoader(folder),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )

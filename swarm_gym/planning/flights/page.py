"""A page with the flight over the ground in three dimensions, which a reader turns; it loads nothing."""

import json
import math
from html import escape
from importlib.resources import files

import numpy as np

from swarm_gym.planning.flights.picture import shaded
from swarm_gym.planning.flights.result import Flight
from swarm_gym.scenarios.terrain.scenario import RADIUS, TOP, X, Y

MOST_POSTS = 160  # of a side of the ground that is drawn


def _top(height: float) -> float | None:
    """Return the height of a top as JSON has it, which knows no infinity."""
    return float(height) if math.isfinite(height) else None


def as_page(flight: Flight) -> str:
    """Return the page as HTML; its script is part of it."""
    scenario = flight.map
    step = math.ceil(max(scenario.heights.shape) / MOST_POSTS)
    heights, colours = scenario.heights[::step, ::step], shaded(scenario)[::step, ::step]
    x, y = scenario.origin
    facts = [
        ("length", f"{flight.length:,.0f} m"),
        ("height above ground", f"{flight.least_height:.0f} to {flight.greatest_height:.0f} m"),
        ("steepest climb", f"{flight.steepest_climb:.0f}°"),
        ("sharpest turn", f"{flight.sharpest_turn:.0f}°"),
        ("waypoints", str(len(flight.waypoints))),
    ]
    data = {
        "rows": heights.shape[0],
        "columns": heights.shape[1],
        "cell": scenario.cell * step,
        "heights": np.round(heights, 1).ravel().tolist(),
        "colours": colours.reshape(-1, 3).tolist(),
        "flight": np.round(flight.waypoints - (x, y, 0.0), 2).tolist(),
        "threats": [
            [*np.round((t[X] - x, t[Y] - y, t[RADIUS]), 2).tolist(), _top(t[TOP])] for t in scenario.threats
        ],
    }
    here = files("swarm_gym.planning.flights")
    template = here.joinpath("page.html").read_text(encoding="utf-8")
    rows = "".join(f"<tr><th>{escape(name)}</th><td>{escape(value)}</td></tr>" for name, value in facts)
    return (
        template.replace("{{title}}", escape(f"A flight over {scenario.name}"))
        .replace("{{facts}}", rows)
        .replace("{{data}}", json.dumps(data, separators=(",", ":")).replace("<", "\\u003c"))
    )

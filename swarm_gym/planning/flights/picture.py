"""Pictures of a flight: from above with the profile of heights, and a page in three dimensions.

A reader turns the flight on the page, which loads nothing.
"""

import io
import json
import math
from html import escape
from importlib.resources import files
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from swarm_gym.errors import MissingExtraError
from swarm_gym.planning.flights.ground_track import ground_track
from swarm_gym.planning.flights.result import Flight
from swarm_gym.scenarios import TerrainScenario
from swarm_gym.scenarios.terrain.scenario import RADIUS, TOP, X, Y, hill_shade

Floats = NDArray[np.float64]

WIDTH, HEIGHT = 900, 3600  # of the picture, and of its map at most, in pixels
PROFILE = 260  # height of the profile, in pixels
LEFT, MARGIN = 64, 14  # of the profile
FINER = 2  # a picture is drawn so many times larger and then reduced, so that edges are smooth
PAPER, INK, FLIGHT, THREAT, START, GOAL = "#ffffff", "#3f3f46", "#c2410c", "#dc2626", "#15803d", "#1d4ed8"
GROUND, BAND = "#a8a29e", "#e0f2fe"
CORNERS = 5001  # of a very large disc
MOST_POSTS = 160  # of a side of the ground on the page
LOW, HIGH = np.array([120.0, 150.0, 105.0]), np.array([240.0, 232.0, 214.0])  # colours by height


def as_png(flight: Flight) -> bytes:
    """Return the picture as PNG.

    Raises:
        MissingExtraError: if Pillow is missing.
    """
    try:
        from PIL import Image, ImageDraw
    except ImportError as error:
        raise MissingExtraError("a picture as PNG", "Pillow", "terrain") from error
    scenario = flight.map
    x_min, y_min, x_max, y_max = scenario.workspace
    scale = FINER * min(WIDTH / (x_max - x_min), HEIGHT / (y_max - y_min))
    width, height = (max(round(scale * extent), 1) for extent in (x_max - x_min, y_max - y_min))
    image = Image.new("RGB", (FINER * WIDTH, height + FINER * PROFILE), PAPER)
    relief = Image.fromarray(shaded(scenario)[::-1])
    image.paste(relief.resize((width, height), Image.Resampling.BILINEAR), (0, 0))
    canvas = ImageDraw.Draw(image, "RGBA")
    for threat in scenario.threats.tolist():
        centre = (scale * (threat[X] - x_min), scale * (y_max - threat[Y]))
        _draw_threat(canvas, centre, scale * threat[RADIUS], width)
    for corner in ((0, height), (width + 1, 0)):  # threats do not reach the profile, nor beyond the map
        if corner[0] < image.width:
            canvas.rectangle((corner, image.size), fill=PAPER)
    places = np.stack(
        [scale * (flight.waypoints[:, 0] - x_min), scale * (y_max - flight.waypoints[:, 1])], axis=-1
    )
    canvas.line([tuple(place) for place in places.tolist()], fill=FLIGHT, width=3 * FINER, joint="curve")
    for place, colour in ((places[0], START), (places[-1], GOAL)):
        canvas.circle(tuple(place.tolist()), 6 * FINER, fill=colour)
    _draw_profile(canvas, flight, height)
    content = io.BytesIO()
    size = WIDTH, round(image.height / FINER)
    image.resize(size, Image.Resampling.BOX).save(content, "PNG", optimize=True)
    return content.getvalue()


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


def _top(height: float) -> float | None:
    """Return the height of a top as JSON has it, which knows no infinity."""
    return float(height) if math.isfinite(height) else None


def shaded(scenario: TerrainScenario) -> NDArray[np.uint8]:
    """Return the ground as colours, (rows, columns, 3): by height, and darker in the shade."""
    light = hill_shade(scenario, max(scenario.heights.shape))
    low, high = scenario.heights.min(), scenario.heights.max()
    share = (scenario.heights - low) / max(high - low, 1e-9)
    colours = (LOW + share[..., None] * (HIGH - LOW)) * (0.35 + 0.75 * light[..., None])
    return np.clip(colours, 0.0, 255.0).astype(np.uint8)


def _draw_threat(canvas: Any, centre: tuple[float, float], radius: float, width: int) -> None:
    """Draw a threat as a disc, in pixels; Pillow is slow at discs that are much larger than the picture."""
    if radius <= width:
        canvas.circle(centre, radius, fill=THREAT + "60", outline=THREAT, width=FINER)
        return
    angles = np.linspace(0.0, 2.0 * np.pi, CORNERS)
    rim = np.array(centre) + radius * np.stack([np.cos(angles), np.sin(angles)], axis=-1)
    corners = [tuple(corner) for corner in rim.tolist()]
    canvas.polygon(corners, fill=THREAT + "60")
    canvas.line(corners, fill=THREAT, width=FINER)


def _draw_profile(canvas: Any, flight: Flight, top: int) -> None:
    """Draw the heights of ground, altitude band and flight over the distance from the start."""
    track = ground_track(flight.task, flight.waypoints[:, :2])
    z = np.interp(track.along, track.along[track.vertices], flight.waypoints[:, 2])
    lowest, highest = flight.map.band
    least, most = float(track.ground.min()), float(max(z.max(), (track.ground + highest).max()))
    bottom = top + FINER * (PROFILE - 2 * MARGIN)
    across = FINER * (WIDTH - LEFT - MARGIN) / track.along[-1]
    up = (bottom - top - 2 * FINER * MARGIN) / max(most - least, 1e-9)

    def line(heights: Floats) -> list[tuple[float, float]]:
        x = FINER * LEFT + across * track.along
        y = bottom - up * (heights - least)
        return list(zip(x.tolist(), y.tolist(), strict=True))

    band = [*line(track.ground + lowest), *reversed(line(track.ground + highest))]
    canvas.polygon(band, fill=BAND)
    ground = line(track.ground)
    canvas.polygon([(ground[0][0], bottom), *ground, (ground[-1][0], bottom)], fill=GROUND)
    for begin, end in pairwise(line(z)):
        canvas.line([begin, end], fill=FLIGHT, width=2 * FINER)
    for value in (least, most):
        y = bottom - up * (value - least)
        canvas.text((4 * FINER, y - 12), f"{value:.0f} m", fill=INK, font_size=11 * FINER)
    text = f"{flight.length:,.0f} m, {flight.least_height:.0f} to {flight.greatest_height:.0f} m above ground"
    canvas.text((FINER * LEFT, bottom + 4), text, fill=INK, font_size=12 * FINER)

"""Files `.hgt` of the Shuttle Radar Topography Mission: one degree, whose south-west corner is in the name.

Source: "SRTM data format" of the NASA Land Processes DAAC. Heights are big-endian integers in metres, 1201 or
3601 in a row and as many rows, from north to south. The outermost ones lie on whole degrees. -32768 is a gap.
"""

import re
from pathlib import Path

import numpy as np

from swarm_gym.errors import ScenarioError, shown
from swarm_gym.scenarios.formats.data_files import open_file
from swarm_gym.scenarios.formats.elevation import Elevation
from swarm_gym.scenarios.formats.geographic import GEOGRAPHIC

SIDES = (1201, 3601)  # of 3 and 1 seconds of arc
GAP = -32768


def read(path: Path) -> Elevation:
    """Return the content of a file.

    Raises:
        ScenarioError: if the file cannot be read, or its name or size is another one.
    """
    match = re.match(r"([NS])(\d{2})([EW])(\d{3})", path.name, re.IGNORECASE)
    if not match or int(match[2]) > 90 or int(match[4]) > 180:
        raise ScenarioError(
            f"{path}: expected a name that begins with the south-west corner, such as N46E007.hgt, got "
            f"{shown(path.name)}"
        )
    latitude = int(match[2]) * (-1 if match[1] in "sS" else 1)
    longitude = int(match[4]) * (-1 if match[3] in "wW" else 1)
    try:
        with open_file(path) as file:
            content = file.read(2 * SIDES[-1] ** 2 + 1)
    except OSError as error:
        raise ScenarioError(f"{path}: cannot be read: {error}") from error
    sides = {2 * side * side: side for side in SIDES}
    if len(content) not in sides:
        raise ScenarioError(
            f"{path}: expected {' or '.join(map(str, sides))} bytes, for {' or '.join(map(str, SIDES))} "
            f"heights in a row, got {len(content)}{' or more' if len(content) > max(sides) else ''}; is the "
            "file whole?"
        )
    side = sides[len(content)]
    heights = np.frombuffer(content, dtype=">i2").reshape(side, side)[::-1].astype(np.float64)
    heights[heights == GAP] = np.nan
    step = 1.0 / (side - 1)
    return Elevation(
        path, heights, (float(longitude), float(latitude)), (step, step), GEOGRAPHIC, "EPSG:4326"
    )

"""Small files for flights: elevation models in every format, and threats."""

import json

import numpy as np


def hill(rows=61, columns=81):
    """Return whole heights of a hill, rows from south to north; every cell has another height nearby."""
    y, x = np.mgrid[0:rows, 0:columns]
    return np.rint(300.0 + 200.0 * np.exp(-((x - 40.0) ** 2 + (y - 25.0) ** 2) / 150.0) + x + 0.5 * y)


def write_asc(path, heights, cell=50.0, corner=(1000.0, 2000.0), gaps=(), key="corner"):
    """Write an ESRI ASCII grid, whose rows lie from north to south; return its path."""
    values = heights.copy()
    for row, column in gaps:
        values[row, column] = -9999
    rows, columns = heights.shape
    head = (
        f"ncols {columns}\nnrows {rows}\nxll{key} {corner[0]!r}\nyll{key} {corner[1]!r}\ncellsize {cell!r}\n"
    )
    lines = [" ".join(f"{value:g}" for value in row) for row in values[::-1]]
    path.write_text(head + "NODATA_value -9999\n" + "\n".join(lines) + "\n")
    return path


def write_hgt(folder, name="N46E007.hgt", gap=None):
    """Write a tile of 1201 x 1201 heights: a plane that rises by 1 a row to the north, 0.1 to the east."""
    y, x = np.mgrid[0:1201, 0:1201]
    heights = 200 + y + x // 10
    if gap is not None:
        heights[gap] = -32768
    path = folder / name
    path.write_bytes(heights[::-1].astype(">i2").tobytes())
    return path


def write_threats(path, *threats, crs=None):
    """Write points, each (x, y, properties), as GeoJSON; return its path."""
    features = [
        {"type": "Feature", "properties": properties, "geometry": {"type": "Point", "coordinates": [x, y]}}
        for x, y, properties in threats
    ]
    content = {"type": "FeatureCollection", "features": features}
    if crs is not None:
        content["crs"] = {"type": "name", "properties": {"name": crs}}
    path.write_text(json.dumps(content))
    return path

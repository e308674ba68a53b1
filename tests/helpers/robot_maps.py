"""Maps of robots in cells of 0.05 m: a wall with a door, and the floor of an office."""

import numpy as np

from helpers.grids import frozen
from swarm_gym.scenarios import GridMap

RESOLUTION = 0.05
# Blocked cells of the office: first column and row, number of columns and rows.
# fmt: off
OFFICE = (
    (10, 10, 380, 3), (10, 13, 3, 277), (98, 13, 3, 119), (198, 13, 3, 119), (298, 13, 3, 119),
    (387, 13, 3, 277), (13, 19, 1, 1), (97, 20, 4, 1), (240, 30, 16, 50), (386, 34, 4, 1), (297, 35, 4, 1),
    (120, 37, 60, 13), (30, 60, 45, 20), (340, 74, 30, 16), (101, 123, 1, 1), (181, 128, 1, 4),
    (13, 129, 42, 3), (73, 129, 78, 3), (168, 129, 57, 3), (242, 129, 79, 3), (321, 129, 1, 1),
    (338, 129, 52, 3), (39, 132, 1, 1), (190, 144, 16, 12), (199, 156, 1, 1), (36, 168, 1, 4),
    (13, 169, 27, 3), (59, 169, 82, 3), (158, 169, 83, 1), (258, 169, 73, 3), (348, 169, 42, 3),
    (159, 170, 82, 2), (98, 172, 3, 118), (198, 172, 3, 50), (298, 172, 3, 118), (97, 194, 4, 1),
    (135, 199, 1, 31), (130, 200, 16, 30), (320, 200, 12, 60), (301, 211, 1, 1), (97, 219, 4, 1),
    (230, 236, 40, 24), (198, 240, 3, 50), (13, 246, 1, 1), (47, 254, 1, 16), (30, 255, 30, 15),
    (60, 266, 1, 1), (64, 286, 1, 4), (145, 286, 1, 4), (184, 286, 1, 4), (307, 286, 1, 4),
    (13, 287, 377, 3),
)
# fmt: on


def door_map(cells):
    """Return a room of 5 m x 4 m with a wall of one cell, and a door of so many cells in it."""
    blocked = np.zeros((80, 100), dtype=np.bool_)
    blocked[[0, -1]] = blocked[:, [0, -1]] = True
    blocked[:, 50] = True
    blocked[30 : 30 + cells, 50] = False
    return GridMap(f"door{cells}", frozen(blocked), RESOLUTION, (-2.475, 1.975), y_up=True)


def office_map():
    """Return an office of 20 m x 15 m with seven rooms around a corridor, and a gap of 0.60 m."""
    blocked = np.zeros((300, 400), dtype=np.bool_)
    for column, row, width, height in OFFICE:
        blocked[row : row + height, column : column + width] = True
    return GridMap("office", frozen(blocked), RESOLUTION, (-2.975, 12.975), y_up=True)


def write_ros_map(folder, grid):
    """Write a map as the files of map_server, and return the YAML file."""
    grey = np.where(grid.blocked, 0, 254).astype(np.uint8)
    header = f"P5\n{grid.width} {grid.height}\n255\n".encode()
    (folder / f"{grid.name}.pgm").write_bytes(header + grey.tobytes())
    x, y = grid.to_map((-0.5, grid.height - 0.5)).tolist()
    file = folder / f"{grid.name}.yaml"
    file.write_text(
        f"image: {grid.name}.pgm\nresolution: {grid.resolution}\norigin: [{x:.6g}, {y:.6g}, 0.0]\n"
        "negate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.25\n"
    )
    return file

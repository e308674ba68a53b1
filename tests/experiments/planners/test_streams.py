"""Streams of maps: their obstacles, and the table of drives known by hand."""

import numpy as np
import pytest

from experiments.planners.streams import PERIOD, Drive, make_stream, stream_table
from swarm_gym.scenarios import make_scenario


def test_one_obstacle_comes_and_goes_and_another_one_trembles():
    scenario = make_scenario("rooms:2")
    stream = make_stream(scenario, 2, maps=4 * PERIOD)
    sizes = np.array([blocked.sum() for blocked in stream.blocked])
    there = np.arange(4 * PERIOD) // PERIOD % 2 == 1
    assert sizes[there].min() > sizes[~there].max()
    assert all((blocked | scenario.map.blocked == blocked).all() for blocked in stream.blocked)
    assert len({blocked.tobytes() for blocked in stream.blocked}) > 2 * PERIOD
    again = make_stream(scenario, 2, maps=4 * PERIOD)
    np.testing.assert_array_equal(again.blocked, stream.blocked)


def test_the_table_has_a_row_for_each_margin():
    drives = [
        (0.0, Drive(4, [0.01, 0.03], 1.2, True, 0)),
        (0.0, Drive(2, [0.02], 1.0, False, 1)),
        (0.05, Drive(1, [0.05], 1.1, True, 0)),
    ]
    _, _, *rows = [line for line in stream_table(drives).markdown().splitlines() if line.startswith("|")]
    cells = [[cell.strip() for cell in row.strip("|").split("|")] for row in rows]
    assert cells[0][:8] == ["0 %", "2", "3", "3.0", "50.0 %", "1", "110.0 %", "20.0"]
    assert cells[1][:8] == ["5 %", "1", "1", "1.0", "100.0 %", "0", "110.0 %", "50.0"]
    assert [float(row[8]) for row in cells] == [pytest.approx(30.0, abs=1.0), 50.0]

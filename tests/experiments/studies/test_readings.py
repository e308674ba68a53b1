"""The comparison of readings runs what it says."""

import re

from experiments.readings import READINGS, ReadingsConfig, compare_readings
from helpers.stored_runs import printed_rows


def test_every_reading_is_run_and_the_papers_row_stands_above():
    table = compare_readings(ReadingsConfig(case="case3", seeds=2, controllers=("fixed:60", "fixed:80")))
    rows = printed_rows(table)
    assert rows[0] == ("paper", "323.8 (301.0)", "319.7 (301.0)")
    assert [row[0] for row in rows[1:]] == [name for name, _, _ in READINGS]
    results = {row[1:] for row in rows[1:]}
    assert len(results) == len(READINGS)  # every reading changes something
    assert min(float(re.match(r"[\d.]+", cell)[0]) for cells in results for cell in cells) > 300

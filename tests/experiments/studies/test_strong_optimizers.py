"""The published table of MetaBox-v2 is complete, and ours stands beside it."""

import pytest

from experiments.studies.strong.beside_published import beside_published
from experiments.studies.strong.published import (
    FUNCTIONS,
    LEARNED,
    PUBLISHED,
    SCENARIOS,
    YEARS,
    Gap,
    average_ranks,
    best_of,
)
from swarm_gym.scenarios import make_scenario


def test_the_numbers_are_those_printed():
    assert PUBLISHED["RNNOPT"][4] == (2947.0, 0.0)
    assert PUBLISHED["RNNOPT"][12] == (5.096e7, 7.451e-9)
    assert PUBLISHED["DEDDQN"][14] == (4.224e-9, 4.069e-9)
    assert PUBLISHED["GLEET"][23].mean == 0.4839
    assert (YEARS["SHADE"], YEARS["RLDEAFL"]) == (2013, 2025)


def test_the_table_is_complete():
    assert len(PUBLISHED) == 20
    assert set(LEARNED) == set(PUBLISHED) - {"PSO", "DE", "SHADE", "JDE21", "MADDE"}
    assert tuple(make_scenario(name).number for name in SCENARIOS) == FUNCTIONS
    assert all(tuple(gaps) == FUNCTIONS for gaps in PUBLISHED.values())


def test_the_best_of_a_function_has_the_least_mean():
    assert best_of(4) == ("MADDE", PUBLISHED["MADDE"][4])
    assert best_of(7) == ("DEDDQN", (0.0, 0.0))
    assert best_of(22)[0] == "LDE"


def test_ranks_count_those_ahead_and_are_shared_by_equals():
    perfect, copy = {k: Gap(0.0, 0.0) for k in FUNCTIONS}, dict(PUBLISHED["RNNOPT"])
    ranks = average_ranks({"perfect": perfect, "copy": copy})
    assert ranks["perfect"] == 1.0
    assert ranks["copy"] == ranks["RNNOPT"]
    assert next(iter(ranks)) == "perfect"
    alone = average_ranks({})
    assert alone["DEDDQN"] == pytest.approx(ranks["DEDDQN"] - 15 / 16)  # it is perfect on the step ellipsoid


def test_a_star_marks_a_gap_that_no_published_one_is_below():
    ours = {number: Gap(best_of(number)[1].mean, 0.0) for number in FUNCTIONS}
    ours[7], ours[14] = Gap(9e-9, 0.0), Gap(2e-8, 0.0)  # level by the least gap; not level
    table = beside_published({"ours": ours})
    cells = {str(row[0]): str(row[2]) for row in table.rows}
    assert cells["7 StepEllipsoid"] == "9e-09*"
    assert cells["14 DifferentPowers"] == "2e-08"
    assert cells["4 BuecheRastrigin"] == "24.2*"
    assert cells["stars of 16"] == "15"
    assert str(table.rows[0][1]) == "24.2 (MADDE, 2021)"

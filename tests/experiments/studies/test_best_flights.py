"""The best known flights of the study over terrain cost what is stored, by code of the tests' own."""

import json
from itertools import pairwise

import numpy as np
import pytest

from experiments.studies.terrain.best_known import FILE, best_known
from oracles.naive_metabox import cost, waypoints
from swarm_gym.scenarios import make_scenario

KNOWN = best_known("metabox")
TOUCH = 1e-6


def check(terrain):
    """Measure a stored flight again; one whose cost has no contact keeps away from threats, densely."""
    scenario, flight = make_scenario(terrain), KNOWN[terrain]
    assert cost(scenario, flight["encoding"], flight["vector"]) == pytest.approx(flight["cost"], rel=1e-9)
    points = waypoints(scenario, flight["encoding"], flight["vector"])
    level = np.array(points)[:, :2]
    if flight["cost"] < 1e4:  # no contact with a threat costs less than that
        distances = [
            np.hypot(*(one + s * (other - one) - threat[:2])) - threat[3]
            for one, other in pairwise(level)
            for s in np.linspace(0.0, 1.0, 200)
            for threat in scenario.threats
        ]
        assert min(distances) >= scenario.drone_size - TOUCH


def test_every_terrain_for_tests_has_a_flight_with_its_origin():
    assert list(KNOWN) == [f"terrain:test:{k}" for k in range(56)]
    for flight in KNOWN.values():
        assert flight["found_by"]
        assert flight["cost"] > 0.0
    assert FILE.stat().st_size < 100_000
    assert set(json.loads(FILE.read_text(encoding="utf-8"))) == {"metabox"}


@pytest.mark.slow
def test_a_known_flight_costs_what_is_stored():
    check("terrain:test:0")


@pytest.mark.slow
@pytest.mark.parametrize("terrain", KNOWN)
def test_all_known_flights_cost_what_is_stored(terrain):
    check(terrain)

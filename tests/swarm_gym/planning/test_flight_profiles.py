"""Heights over a route: the taut string in the altitude band, held against dense points and descent."""

import math
from itertools import pairwise

import numpy as np
import pytest

from oracles.flown_terrain import faults
from swarm_gym.planning.flights.ground_track import ground_track
from swarm_gym.planning.flights.measures import length_of, measured
from swarm_gym.planning.flights.profile import flown, least_climb
from swarm_gym.scenarios import TerrainScenario
from swarm_gym.scenarios.terrain.survey import Survey


def rough(seed=0, side=31, cell=20.0, height=120.0, **options):
    """Return a task over rough ground, in cells that are not square to the route."""
    rng = np.random.default_rng(seed)
    coarse = rng.random((side // 5 + 2, side // 5 + 2))
    y, x = np.mgrid[0:side, 0:side] / 5.0
    i, j = x.astype(int), y.astype(int)
    smooth = coarse[j, i] * (1 - x + i) * (1 - y + j) + coarse[j, i + 1] * (x - i) * (1 - y + j)
    smooth += coarse[j + 1, i] * (1 - x + i) * (y - j) + coarse[j + 1, i + 1] * (x - i) * (y - j)
    heights = height * smooth + 3.0 * rng.random((side, side))
    far = cell * (side - 2)
    given = {"start": (15.0, 25.0, 150.0), "goal": (far, far - 11.0, 140.0), "cell": cell, **options}
    return TerrainScenario("rough", heights, **given)


def straight(scenario):
    return np.array([scenario.start[:2], scenario.target])


@pytest.mark.parametrize("seed", range(8))
def test_a_flight_over_a_route_has_no_fault(seed):
    rng = np.random.default_rng(seed)
    scenario = rough(seed)
    start, goal = straight(scenario)
    along = np.sort(rng.random(4))[:, None]
    route = np.vstack([start, start + along * (goal - start) + 15.0 * rng.normal(size=(4, 2)), goal])
    scenario = rough(seed, largest_turn=180.0)
    flight = flown(Survey(scenario), route)
    assert flight is not None
    assert faults(scenario, flight.tolist()) == []


def test_no_flight_in_the_band_is_shorter():
    scenario = rough(3, band=(20.0, 60.0), start=(15.0, 25.0, 40.0), goal=(560.0, 549.0, 40.0))
    from swarm_gym.planning.flights import profile

    track = ground_track(Survey(scenario), straight(scenario), finer_ends=True)
    low, high = profile._channel(scenario, track)
    places, heights = profile._taut(track.along, low, high)
    z = np.interp(track.along, track.along[places], heights)
    assert (z >= low - 1e-9).all()
    assert (z <= high + 1e-9).all()
    shortest = np.hypot(np.diff(track.along), np.diff(z)).sum()
    # Pulling nodes towards the chord of their neighbours shortens any other flight until it is this one.
    other = np.clip(0.5 * (low + high), low, high)
    share = np.diff(track.along)[:-1] / (track.along[2:] - track.along[:-2])
    for round_ in range(40_000):
        chord = other[:-2] + (other[2:] - other[:-2]) * share
        odd = slice(round_ % 2, None, 2)
        other[1:-1][odd] = np.clip(chord, low[1:-1], high[1:-1])[odd]
    pulled = np.hypot(np.diff(track.along), np.diff(other)).sum()
    assert shortest <= pulled + 1e-9
    assert shortest == pytest.approx(pulled, rel=1e-6)


def test_a_flight_passes_over_a_threat_with_a_top_and_not_through_one_without():
    low = ((300.0, 300.0, 150.0, 60.0),)
    scenario = rough(1, threats=low)
    flight = flown(Survey(scenario), straight(scenario))
    assert flight is not None
    assert faults(scenario, flight.tolist()) == []
    assert measured(Survey(scenario), flight).passed[0].distance < 0.0
    assert flown(Survey(rough(1, threats=((300.0, 300.0, math.inf, 60.0),))), straight(scenario)) is None
    assert flown(Survey(rough(1, threats=((300.0, 300.0, 500.0, 60.0),))), straight(scenario)) is None


@pytest.mark.parametrize("shares", [(0.0, 0.0), (0.0, 1.0), (1.0, 0.3), (0.02, 0.98)])
@pytest.mark.parametrize("seed", range(6))
def test_a_flight_from_a_limit_of_the_band_keeps_it_in_the_first_and_the_last_cell(seed, shares):
    rng = np.random.default_rng(seed)
    heights = 12.0 * rng.random((9, 9))
    band = (100.0, 130.0)
    above = np.array([band[0] + share * (band[1] - band[0]) for share in shares])
    # Near a post, on a line between cells, and anywhere.
    places = (
        np.array([[60.0 - 1e-9, 60.0 - 1e-9], [60.0, 71.0], [67.0, 49.0]])[seed % 3],
        rng.uniform(150, 170, 2),
    )
    start, goal = ((*place.tolist(), one) for place, one in zip(places, above.tolist(), strict=True))
    scenario = TerrainScenario(
        "rough", heights, start, goal, cell=30.0, band=band, largest_climb=60.0, largest_turn=180.0
    )
    task = Survey(scenario)
    for route in (straight(scenario), np.vstack([start[:2], rng.uniform(40, 200, 2), goal[:2]])):
        flight = flown(task, route)
        assert flight is not None
        found = measured(task, flight)
        assert band[0] - 1e-6 <= found.least_height <= found.greatest_height <= band[1] + 1e-6
        assert faults(scenario, flight.tolist()) == []
        assert least_climb(task, route) <= found.steepest_climb + 1e-6


def test_a_flight_within_one_cell_keeps_away_from_threats_and_ground():
    ends = {"start": (1100.0, 1100.0, 110.0), "goal": (1900.0, 1900.0, 110.0), "cell": 1000.0}
    saddle = np.zeros((4, 4))
    saddle[1, 2] = saddle[2, 1] = 400.0
    scenario = TerrainScenario("saddle", saddle, **ends)
    flight = flown(Survey(scenario), straight(scenario))
    assert flight is not None
    assert faults(scenario, flight.tolist()) == []
    assert measured(Survey(scenario), flight).least_height >= 100.0
    low = TerrainScenario("low", saddle, **ends, band=(100.0, 120.0), largest_climb=5.0)
    assert flown(Survey(low), straight(low)) is None
    for top in (math.inf, 400.0):  # off the band
        blocked = TerrainScenario(
            "blocked", np.zeros((4, 4)), threats=((1500.0, 1500.0, top, 100.0),), **ends
        )
        assert flown(Survey(blocked), straight(blocked)) is None
        assert least_climb(Survey(blocked), straight(blocked)) == math.inf


@pytest.mark.parametrize(
    ("options", "route"),
    [
        ({"largest_turn": 20.0}, [(15, 25), (300, 500), (580, 569)]),
        ({"largest_climb": 0.5}, [(15, 25), (580, 569)]),
        ({}, [(15, 25), (300, -5), (580, 569)]),
        ({}, [(15, 25), (300, 900), (580, 569)]),
    ],
)
def test_what_cannot_be_flown_is_known(options, route):
    assert flown(Survey(rough(2, **options)), np.array(route, dtype=float)) is None
    assert flown(Survey(rough(2)), np.array([(15.0, 25.0), (580.0, 569.0)])) is not None


def test_measures_are_those_of_dense_points():
    scenario = rough(4, threats=((200.0, 400.0, math.inf, 30.0), (400.0, 420.0, math.inf, 10.0)))
    flight = flown(Survey(scenario), straight(scenario))
    found = measured(Survey(scenario), flight)
    shares = np.linspace(0.0, 1.0, 4000)[:, None]
    dense = np.vstack([begin + (end - begin) * shares for begin, end in pairwise(flight)])
    above = dense[:, 2] - scenario.ground(dense[:, :2])
    assert found.least_height == pytest.approx(above.min(), abs=2e-3)
    assert found.greatest_height == pytest.approx(above.max(), abs=2e-3)
    assert found.least_height <= above.min() + 1e-9
    assert found.greatest_height >= above.max() - 1e-9
    distances = {
        number: np.hypot(*(dense[:, :2] - threat[:2]).T).min() - threat[3]
        for number, threat in enumerate(scenario.threats)
    }
    assert {one.number: one.distance for one in found.passed} == pytest.approx(distances, abs=1e-3)
    assert [one.distance for one in found.passed] == sorted(one.distance for one in found.passed)
    assert length_of(flight) == pytest.approx(np.sqrt((np.diff(dense, axis=0) ** 2).sum(axis=1)).sum())
    assert found.sharpest_turn == pytest.approx(0.0, abs=1e-6)
    assert found.steepest_climb <= scenario.largest_climb

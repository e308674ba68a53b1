import numpy as np
import pytest
from gymnasium.error import Error
from gymnasium.utils import seeding
from gymnasium.vector import AutoresetMode

from helpers.episode_seeds import episode_seed
from swarm_gym.compiler.elementary import exp, log
from swarm_gym.compiler.random_stream import seed_stream
from swarm_gym.env import SwarmEnv
from swarm_gym.episode_seeds import EpisodeSeeds, draw_seeds, read_seeds
from swarm_gym.errors import SettingError
from swarm_gym.optimizers import get_optimizer
from swarm_gym.reset_options import draw_beginnings
from swarm_gym.settings import Settings
from swarm_gym.vector_env import SwarmVectorEnv
from swarm_gym.worlds import Worlds
from swarm_gym.wrappers import GroupedEpisodes, PairedReward

FIREFLY = get_optimizer("firefly")


def sequences(seed, count):
    """Return the seeds of the first episodes of a generator, by NumPy."""
    generator = seeding.np_random(seed)[0]
    return [episode_seed(generator) for _ in range(count)]


def one_by_one(seeds, settings, worlds, scenario):
    """Return the draws of seeds, by NumPy's generators one after the other."""
    drawn = []
    for seed in seeds:
        for_numbers, for_stream = seed.spawn(2)
        generator = np.random.default_rng(for_numbers)
        number, price = int(generator.integers(len(worlds.first))), settings.price
        if isinstance(price, tuple):
            low, high = log(price)
            price = float(exp(low + (high - low) * generator.random()))
        problem = worlds.first[number if scenario is None else scenario]
        drawn.append((int(problem), float(price), seed_stream(for_stream).tolist()))
    return drawn


def as_rows(drawn):
    return list(zip(*(part.tolist() for part in drawn), strict=True))


def test_seeds_drawn_ahead_are_those_that_numpy_draws_one_by_one():
    seeds = EpisodeSeeds(3)
    seeds.begin({0: 4, 1: 5, 2: 6})
    expected = [iter([one.entropy for one in sequences(4 + row, 100)]) for row in range(3)]
    rng = np.random.default_rng(0)
    for _ in range(80):
        rows = np.flatnonzero(rng.random(3) < 0.6)
        assert seeds.next_of(rows).tolist() == [next(expected[row]) for row in rows]


def test_a_swarm_that_is_given_a_seed_begins_with_it_and_the_others_go_on():
    seeds = EpisodeSeeds(2)
    seeds.begin({0: 1, 1: 2})
    rows = np.arange(2)
    seeds.next_of(rows)
    seeds.begin({0: 9})
    found = seeds.next_of(rows).tolist()
    assert found == [sequences(9, 1)[0].entropy, sequences(2, 2)[1].entropy]


def test_no_swarm_is_given_a_seed_if_one_of_the_seeds_is_refused():
    seeds = EpisodeSeeds(2)
    seeds.begin({0: 1, 1: 2})
    with pytest.raises(Error, match="-3"):
        seeds.begin({0: 9, 1: -3})
    assert seeds.next_of(np.arange(1)).tolist() == [sequences(1, 1)[0].entropy]


def test_swarms_without_a_seed_differ():
    first, second = EpisodeSeeds(2).next_of(np.arange(2)).tolist()
    assert first != second


@pytest.mark.parametrize("price", [0.25, (0.01, 3.0)])
@pytest.mark.parametrize("scenario", [None, 4])
def test_seeds_draw_what_numpy_draws_one_after_the_other(price, scenario):
    names = ["case1", "case2", "case3", "random-fields:train:0-3"]
    settings = Settings.from_options(FIREFLY, {"scenario": names, "price": price})
    worlds = Worlds(settings, 1)
    expected = one_by_one(sequences(8, 50), settings, worlds, scenario)
    words = draw_seeds(seeding.np_random(8)[0], 50)
    assert as_rows(draw_beginnings(words, settings, worlds, scenario)) == expected
    assert as_rows(draw_beginnings(sequences(8, 50), settings, worlds, scenario)) == expected
    again = sequences(8, 1) * 2  # which has two children more at the second time
    assert as_rows(draw_beginnings(again, settings, worlds, scenario)) == one_by_one(
        sequences(8, 1) * 2, settings, worlds, scenario
    )


@pytest.mark.parametrize(
    ("given", "expected"),
    [
        (5, [5, 6, 7]),
        (np.int64(5), [5, 6, 7]),
        ([4, None, np.int32(9)], [4, None, 9]),
        ((1, 1, 1), [1, 1, 1]),
        (np.array([3, 2, 1]), [3, 2, 1]),
    ],
)
def test_a_vector_takes_one_seed_or_one_for_each_swarm(given, expected):
    assert read_seeds(given, 3) == expected


VECTORS = (
    lambda: SwarmVectorEnv(3, scenario="case1"),
    lambda: GroupedEpisodes(SwarmVectorEnv(3, scenario="case1", autoreset_mode=AutoresetMode.DISABLED), 3),
    lambda: PairedReward(
        SwarmVectorEnv(3, scenario="case1", autoreset_mode=AutoresetMode.SAME_STEP), "fixed:80"
    ),
)


@pytest.mark.parametrize(
    ("given", "said"),
    [
        (True, "an integer or a list of integers, got True"),
        (1.5, "got 1.5"),
        ("3", "got '3'"),
        (np.array(3.0), "an integer or a list of integers"),
        (np.eye(3), "an integer or a list of integers"),
        ([], "expected 3 seeds, one per swarm, got 0"),
        ([1, 2], "expected 3 seeds, one per swarm, got 2"),
        ([1, 2.5, 3], r"expected integers in the list, got 2\.5"),
        ([False, 2, 3], "expected integers in the list, got False"),
    ],
)
@pytest.mark.parametrize("make", VECTORS, ids=["native", "grouped", "paired"])
def test_malformed_seeds_are_refused_by_every_vector(make, given, said):
    with pytest.raises(SettingError, match=f"seed.*{said}"):
        make().reset(seed=given)


def test_single_environments_and_vectors_have_the_same_streams_in_later_episodes():
    swarms, alone = SwarmVectorEnv(2, scenario="case1"), SwarmEnv(scenario="case1")
    swarms.reset(seed=[7, 8])
    alone.reset(seed=8)
    for _ in range(20):
        streams = swarms.simulation.swarms.stream
        assert streams[1].tolist() == alone.simulation.swarms.stream[0].tolist()
        assert streams[0].tolist() != streams[1].tolist()
        swarms.reset()
        alone.reset()


def test_as_many_seeds_as_chosen_swarms_are_asked_for():
    simulation = SwarmVectorEnv(2, scenario="case1").simulation
    seeds = [np.random.SeedSequence(seed) for seed in range(2)]
    with pytest.raises(ValueError, match="expected 1 seeds, one per chosen swarm, got 2"):
        simulation.reset(np.array([True, False]), seeds)
    simulation.reset(np.array([True, False]), seeds[:1])

"""Comparison of controllers: the same bits as a suite of the laboratory, intervals, tables, bad input."""

import csv
import dataclasses

import numpy as np
import pytest

from experiments.runs.episode import Episode
from experiments.studies.spsfa.suites import PAPER
from swarm_gym.comparing import ComparedRuns, compare
from swarm_gym.comparing.command_line import main
from swarm_gym.comparing.compared_runs import COLUMNS
from swarm_gym.comparing.entrants import iterate
from swarm_gym.controllers import make_controller
from swarm_gym.env import SwarmEnv
from swarm_gym.errors import ScenarioError, SettingError, UnknownNameError

SHORT = {"iterations": 6}
TWO = ["fixed:8", "fixed:10"]


@pytest.fixture(scope="module")
def runs():
    return compare(TWO, ["case1", "case3"], range(3), **SHORT)


def test_a_run_is_the_run_of_a_suite_bit_for_bit(runs):
    suite = dataclasses.replace(
        PAPER, controllers=tuple(TWO), scenarios=("case1", "case3"), options=SHORT, snapshots=()
    )
    episode = Episode(("fixed:10", "case3", 2), suite)
    for _ in episode:
        pass
    assert runs.fitness[1, 1, 2] == episode.info["best_fitness"]
    assert runs.collision[1, 1, 2] == episode.info["best_collision"]
    assert runs.evaluations[1, 1, 2] == episode.info["evaluations"]


def test_a_controller_of_ones_own_runs_as_the_one_with_a_name(runs):
    mine = compare({"mine": make_controller("fixed:10")}, ["case1", "case3"], range(3), **SHORT)
    assert mine.controllers == ("mine",)
    np.testing.assert_array_equal(mine.fitness[0], runs.fitness[1])


def test_a_name_may_begin_with_an_optimizer():
    found = compare(["fixed:8", "particle-swarm+fixed:8"], ["case1"], range(2), **SHORT)
    alone = compare(["fixed:8"], ["case1"], range(2), optimizer="particle-swarm", **SHORT)
    np.testing.assert_array_equal(found.fitness[1], alone.fitness[0])
    assert (found.fitness[0] != found.fitness[1]).all()


def test_gap_and_objective_follow_from_fitness_optimum_and_evaluations(runs):
    optima = runs.optima[None, :, None]
    np.testing.assert_allclose(runs.gap, (runs.fitness - optima) / optima, rtol=1e-12)
    expected = 100 * runs.gap + 5 * runs.evaluations / 100_000
    np.testing.assert_allclose(runs.objective(5), expected, rtol=1e-12)


def test_means_lie_in_their_intervals_and_the_first_differs_from_itself_by_nothing(runs):
    for mean, (low, high) in runs.mean(runs.objective()):
        assert low < mean < high
    first, second = runs.difference(runs.objective())
    assert first == (0.0, (0.0, 0.0))
    expected = (runs.objective()[1] - runs.objective()[0]).mean()
    assert second[0] == pytest.approx(expected)
    assert second[1][0] <= expected <= second[1][1]


def made_up(fitness, sets, optima):
    """Return runs with these numbers of fitness; all else is equal."""
    fitness = np.asarray(fitness, dtype=np.float64)
    names = tuple(f"c{k}" for k in range(len(fitness)))
    cost = np.full(fitness.shape, 100_000.0)
    zeros, seeds = np.zeros(fitness.shape), tuple(range(fitness.shape[2]))
    return ComparedRuns(names, sets, seeds, fitness, zeros, zeros == 0, cost, np.asarray(optima))


def test_scenarios_of_a_set_are_resampled_and_those_that_stand_alone_are_not():
    fitness = [[[110.0, 110.0], [130.0, 130.0]]]
    alone = made_up(fitness, {"a": ("a",), "b": ("b",)}, [100.0, 100.0])
    drawn = made_up(fitness, {"ab": ("a", "b")}, [100.0, 100.0])
    mean, ends = alone.mean(alone.objective())[0]
    assert (mean, ends) == (pytest.approx(21.0), (pytest.approx(21.0), pytest.approx(21.0)))
    low, high = drawn.mean(drawn.objective())[0][1]
    assert (low, high) == (pytest.approx(11.0), pytest.approx(31.0))


def test_the_table_has_a_row_for_each_controller_and_a_column_for_each_scenario():
    runs = made_up([[[110.0, 110.0], [130.0, 130.0]]] * 2, {"a": ("a",), "b": ("b",)}, [100.0, 100.0])
    header, first, second = runs.table(price=2.0).splitlines()
    assert header.split("  ")[0] == "controller"
    assert "objective at price 2" in header
    assert first.split() == [
        "c0", "22.000", "[22.000,", "22.000]", "100", "%", "100,000", "10.00", "%", "at", "100k", "30.00",
        "%", "at", "100k",
    ]  # fmt: skip
    assert "+0.000 [+0.000, +0.000]" in second
    assert str(runs) == runs.table(price=1.0)


def test_without_an_optimum_fitness_takes_the_place_of_the_objective():
    runs = made_up([[[110.0, 112.0]], [[120.0, 122.0]]], {"a": ("a",)}, [np.nan])
    header, _, second = runs.table().splitlines()
    assert "best fitness" in header
    assert "121.000" in second
    assert "+10.000" in second
    with pytest.raises(ScenarioError, match="optimum"):
        runs.objective()


@pytest.mark.parametrize(
    ("arguments", "error", "message"),
    [
        (([], ["case1"], range(2)), SettingError, "controllers: expected a list with at least one"),
        ((TWO, ["case1"], []), SettingError, "seeds: expected a list with at least one"),
        ((TWO, ["case1"], [0]), SettingError, "seeds: expected at least 2, since an interval needs 2 runs"),
        ((TWO, ["case1"], [0, -1]), SettingError, "seed must lie in"),
        ((TWO, ["case1"], [0, 0]), SettingError, "seeds: each one once"),
        ((TWO, ["rooms:0-2", "rooms:1"], range(2)), SettingError, "scenarios: each one once"),
        (([*TWO, TWO[0]], ["case1"], range(2)), SettingError, "controllers: each one once"),
        (("fixed:8", ["case1"], range(2)), SettingError, "controllers: expected a list of names"),
        ((TWO, "case1", range(2)), SettingError, "scenarios: expected a list of names"),
        ((["nobody"], ["case1"], range(2)), UnknownNameError, "nobody"),
        ((["nobody+fixed:8"], ["case1"], range(2)), UnknownNameError, "nobody"),
        ((TWO, ["nowhere"], range(2)), UnknownNameError, "nowhere"),
    ],
)
def test_bad_input_is_refused_before_anything_runs(arguments, error, message):
    begun = []
    with pytest.raises(error, match=message):
        compare(*arguments, report=begun.append)
    assert begun == []


def test_seeds_may_be_an_array_and_names_are_a_list():
    seeds = np.arange(3, 5)
    both = [compare(["fixed:8"], ["case3"], given, **SHORT).fitness for given in (seeds, [3, 4])]
    np.testing.assert_array_equal(*both)
    with pytest.raises(SettingError, match="controllers: expected a list of names, got <generator"):
        compare((name for name in ["fixed:8"]), ["case3"])
    with pytest.raises(SettingError, match="expected a controller as 'a', got 'fixed:20'"):
        compare({"a": "fixed:20"}, ["case3"])


def test_one_seed_is_enough_for_a_set_of_scenarios():
    assert compare(["fixed:8"], ["rooms:0-1"], [0], **SHORT, encoding="bezier").fitness.shape == (1, 2, 1)


def test_the_command_prints_the_table_and_writes_all_runs(tmp_path, capsys):
    path = tmp_path / "runs.csv"
    main([*TWO, "--scenarios", "case3", "--seeds", "2", "--first-seed", "7", "--output", str(path)])
    printed = capsys.readouterr()
    assert printed.err.splitlines() == ["running fixed:8", "running fixed:10"]
    assert "objective at price 1" in printed.out
    header, *rows = csv.reader(path.read_text().splitlines())
    assert tuple(header) == COLUMNS
    assert [row[:3] for row in rows] == [[name, "case3", seed] for name in TWO for seed in ("7", "8")]
    again = compare(TWO, ["case3"], [7, 8])
    assert [float(row[3]) for row in rows] == again.fitness.ravel().tolist()


def test_the_command_compares_with_options_of_environments(tmp_path):
    path = tmp_path / "runs.csv"
    options = {"source": "smooth", "encoding": "bezier", "iterations": 9, "max_evaluations": 40}
    given = [word for name, value in options.items() for word in (f"--{name.replace('_', '-')}", str(value))]
    main(["fixed:8", "--scenarios", "rooms:0", "--seeds", "2", "--output", str(path), *given])
    _, *rows = csv.reader(path.read_text().splitlines())
    again = compare(["fixed:8"], ["rooms:0"], range(2), **options)
    assert [float(row[3]) for row in rows] == again.fitness.ravel().tolist()
    assert (again.evaluations <= 40).all()


def test_parameters_of_optimizers_and_sizes_reach_environments_and_controllers():
    found = compare(["fixed:8"], ["case1"], range(2), noise=3.0, **SHORT)
    assert found.evaluations.sum() != compare(["fixed:8"], ["case1"], range(2), **SHORT).evaluations.sum()
    sizes = {"min_population_size": 40, "initial_population_size": 60, "iterations": 20}
    assert np.isfinite(compare(["linear-reduction", "random"], ["case1"], range(2), **sizes).fitness).all()
    distinct = {"optimizer": "one-plus-lambda-lambda", "counting": "copies-free"}
    assert (compare(["theory"], ["onemax:20"], range(2), **distinct).fitness == 0.0).all()


@pytest.mark.parametrize(
    "options",
    [
        ["--seeds", "1"],
        ["--price", "-1"],
        ["--price", "inf"],
        ["--scenarios", "case1", "case1"],
        ["--first-seed", "100000"],
    ],
)
def test_the_command_ends_with_a_message_for_bad_input(options):
    with pytest.raises(SystemExit) as ended:
        main(["fixed:8", *options])
    assert str(ended.value.code).startswith("error: ")


def test_gaps_are_to_the_optimum_of_the_optimizers_encoding():
    runs = compare(["fixed:8"], ["case1"], range(2), "ant-colony", iterations=5)
    env = SwarmEnv("ant-colony", scenario="case1", iterations=5, initial_population_size=8)
    controller = make_controller("fixed:8")
    for seed in range(2):
        *_, info = iterate(env, controller, seed)
        assert runs.gap[0, 0, seed] == pytest.approx(info["optimality_gap"])
    with pytest.raises(
        SettingError, match=r"different encodings.*'waypoints' of firefly, 'walk' of ant-colony"
    ):
        compare(["fixed:8", "ant-colony+fixed:8"], ["case1"], range(2), iterations=5)


def test_an_entrant_with_longer_episodes_runs_on_a_late_event():
    found = compare(["firefly(30)+fixed:5", "firefly(31)+fixed:5"], ["dynamic:case1-block@29"], range(2))
    assert np.isfinite(found.optima).all()
    assert (found.evaluations[0] < found.evaluations[1]).all()

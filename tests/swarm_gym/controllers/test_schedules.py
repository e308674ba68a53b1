"""The SPSFA schedule as a controller against Algorithm 2 of the paper, written straight down."""

import math

import numpy as np
import pytest

from agents import SizeLimits, make_controller
from helpers.compiled import compiled
from helpers.episode_seeds import episode_seed
from swarm_gym.compiler.random_stream import fill_uniform, seed_stream
from swarm_gym.controllers.schedules import SelfAdaptiveSchedule, parameter_ranges
from swarm_gym.env import SwarmEnv
from swarm_gym.errors import SettingError
from swarm_gym.history import HISTORY
from swarm_gym.population import Swarms, make_workspace, resize, summarise
from swarm_gym.problem import AnalyticProblem
from swarm_gym.problem.tables import evaluate_entry, repair_entry
from swarm_gym.scenarios import make_scenario


class PaperAlgorithm2:
    """SPSFA-TIP from the printed pseudocode: one population, one loop, no controller, no environment.

    Uses the tested kernels for cost, repair, random numbers, E(P) and resizing, so that the comparison can be
    bit for bit; moves, order, rules and bookkeeping are written out.
    """

    omega, eta, low_deviation, k = 1000.0, 0.2, 20.0, 0.1
    alpha, beta0, gamma = 2.0, 0.1, 5e-6
    smallest, largest = 2, 200

    def __init__(self, scenario, seed, size, iterations, treatment):
        self.problem = AnalyticProblem(make_scenario(scenario))
        self.table = self.problem.table
        self.iterations, self.treatment = iterations, treatment
        # The environment's seeding: generator of the seed, episode, then scenario and stream.
        generator = np.random.Generator(np.random.PCG64(np.random.SeedSequence(seed)))
        self.stream = seed_stream(episode_seed(generator).spawn(2)[1])
        self.swarms = Swarms.allocate(1, self.largest, 31)
        self.swarms.stream[0] = self.stream
        self.swarms.budget[0] = 10**12
        self.trace = []
        table, swarms = self.table, self.swarms
        for i in range(size):
            draw = self.uniform()
            swarms.positions[0, i] = table.initial_lower + (table.initial_upper - table.initial_lower) * draw
            self.assess(i)
        swarms.size[0] = size

    def uniform(self):
        out = np.empty(32)
        compiled(fill_uniform)(self.swarms.stream[0], out)
        return out

    def assess(self, i):
        path = np.concatenate([[0.0], self.swarms.positions[0, i]])
        f, c = evaluate_entry(self.table, path)
        self.swarms.fitness[0, i], self.swarms.collision[0, i] = f, c
        self.swarms.evaluations[0] += 1
        self.swarms.best_fitness[0] = min(self.swarms.best_fitness[0], f)

    def attraction(self, i, j):
        x, y = self.swarms.positions[0, i], self.swarms.positions[0, j]
        squares = (y - x) ** 2
        # The kernel's order of summation: eight accumulators, then by halves.
        sums = [0.0] * 8
        for index in range(32):
            sums[index % 8] += squares[index]
        fours = [sums[k] + sums[k + 4] for k in range(4)]
        distance = (fours[0] + fours[2]) + (fours[1] + fours[3])
        return self.beta0 * math.exp(-self.gamma * distance)

    def move(self, i, j, phi):
        positions = self.swarms.positions[0]
        pull, noise = self.attraction(i, j), self.uniform()
        moved = positions[i] + pull * (positions[j] - positions[i]) + self.alpha * (noise - 0.5)
        positions[i] = np.clip(moved, self.table.lower, self.table.upper)
        if phi > 0:
            path = np.concatenate([[0.0], positions[i]])
            repair_entry(self.table, path, phi)
            positions[i] = path[1:]
        self.assess(i)

    def population_collision(self):
        compiled(summarise)(self.swarms, 0, self.k)
        return self.swarms.summary[0, 0], self.swarms.summary[0, 2]

    def run(self):
        swarms = self.swarms
        e_init, _ = self.population_collision()
        ps = ps_max = int(swarms.size[0])
        phi = 0.0
        for g in range(self.iterations):
            for i in range(ps):
                for j in range(ps):
                    if swarms.fitness[0, j] < swarms.fitness[0, i]:
                        self.move(i, j, phi)
            e, deviation = self.population_collision()
            self.trace.append((e, ps, phi, swarms.best_fitness[0], swarms.evaluations[0]))
            if g == self.iterations - 1:
                break
            new = ps + self.omega / ps if e > e_init else ps_max * (e / e_init) ** self.eta
            ps = min(max(math.floor(new + 0.5), self.smallest), self.largest)
            ps_max = max(ps_max, ps)
            compiled(resize)(swarms, 0, self.table, make_workspace(32), ps)
            treated = self.treatment and deviation <= self.low_deviation
            phi = min(max(2.0 * ps_max / ps**2, 0.0), 1.0) if treated else 0.0
        return np.array(self.trace)


def run_through_environment(name, scenario, seed, iterations, size):
    controller = SelfAdaptiveSchedule(name == "spsfa-tip", initial_population_size=size)
    env = SwarmEnv(scenario=scenario, iterations=iterations, initial_population_size=size)
    controller.reset(1)
    observation, _ = env.reset(seed=seed)
    ended = False
    while not ended:
        observation, _, ended, _, _ = env.step(controller.act(observation[None])[0])
    return env.simulation.history[0, 1:, : HISTORY.index("evaluations") + 1]


@pytest.mark.parametrize("name", ["spsfa", "spsfa-tip"])
@pytest.mark.parametrize(
    ("scenario", "seed"),
    [("case1", 0), *(pytest.param(f"case{k + 1}", k, marks=pytest.mark.slow) for k in (1, 2))],
)
def test_schedule_through_the_environment_equals_algorithm_2(name, scenario, seed):
    expected = PaperAlgorithm2(scenario, seed, 12, 40, name == "spsfa-tip").run()
    found = run_through_environment(name, scenario, seed, 40, 12)
    np.testing.assert_array_equal(found, expected)
    assert len(set(expected[:, 1])) > 3  # sizes that changed
    assert (expected[:, 2] > 0).any() == (name == "spsfa-tip")


@pytest.mark.slow
@pytest.mark.parametrize("scenario", ["case1", "case2", "case3"])
def test_a_whole_run_of_spsfa_tip_equals_algorithm_2(scenario):
    expected = PaperAlgorithm2(scenario, 5, 80, 100, True).run()
    np.testing.assert_array_equal(run_through_environment("spsfa-tip", scenario, 5, 100, 80), expected)


def observed(e, deviation=0.0, iteration=1):
    return np.array([[e, 0.0, deviation, iteration]])


def begun(e_init=50.0, **options):
    controller = SelfAdaptiveSchedule(**{"treats_infeasible_paths": True, **options})
    controller.reset(1)
    assert controller.act(observed(e_init, iteration=0)).tolist() == [
        [controller.initial_population_size, 0.0]
    ]
    return controller


def test_up_rule_adds_omega_over_the_size():
    controller = begun(initial_population_size=60)
    assert controller.act(observed(51.0))[0, 0] == 77  # 60 + 1000/60 = 76.7
    assert controller.act(observed(51.0))[0, 0] == 90  # 77 + 1000/77 = 89.99


def test_down_rule_follows_e_from_the_largest_size():
    controller = begun(initial_population_size=60)
    controller.act(observed(51.0))
    assert controller.act(observed(25.0))[0, 0] == math.floor(77 * 0.5**0.2 + 0.5)
    assert controller.act(observed(50.0))[0, 0] == 77


def test_phi_is_gated_by_the_deviation_and_computed_from_the_new_size():
    controller = begun(initial_population_size=80)
    assert controller.act(observed(25.0, deviation=20.1))[0, 1] == 0.0
    size, repair_degree = controller.act(observed(0.05, deviation=20.0))[0]
    assert repair_degree == 2 * 80 / size**2


def test_where_the_printed_rules_divide_by_zero_or_exceed_the_limits_sizes_stay_valid():
    assert begun().act(observed(0.0))[0].tolist() == [2.0, 1.0]  # E = 0: floor, phi clipped to 1
    assert begun(e_init=0.0).act(observed(0.0))[0, 0] == 80  # nothing to relate to: keep the size
    capped = begun(limits=SizeLimits(2, 85))
    assert capped.act(observed(51.0))[0, 0] == 85


def test_a_floor_keeps_the_size_up_and_the_first_size_is_not_its_business():
    floored = begun(smallest=30, initial_population_size=20)
    assert floored.act(observed(0.01))[0, 0] == 30
    assert begun(limits=SizeLimits(7, 100)).act(observed(0.0))[0, 0] == 7


def test_the_factor_multiplies_phi_before_it_is_clipped():
    for factor in (0.0, 0.5, 3.0, 1e6):
        size, repair_degree = begun(repair_factor=factor).act(observed(0.05))[0]
        assert repair_degree == min(factor * (2 * 80 / size**2), 1.0)


EVERY_PARAMETER = {
    "growth": 1250.5,
    "decay": 0.1,
    "low_deviation": 0.0,
    "initial_population_size": 60,
    "smallest": 2,
    "repair_factor": 1e-7,
}


@pytest.mark.parametrize("family", ["spsfa", "spsfa-tip"])
@pytest.mark.parametrize("chosen", [[], ["growth"], ["smallest", "decay"], list(EVERY_PARAMETER)])
def test_a_schedule_is_named_by_what_differs_and_made_again_by_its_name(family, chosen):
    values = {name: EVERY_PARAMETER[name] for name in chosen}
    schedule = SelfAdaptiveSchedule(family == "spsfa-tip", **values)
    assert make_controller(schedule.name) == schedule
    assert make_controller(schedule.name).name == schedule.name


def test_names_of_schedules_are_canonical():
    name = "spsfa-tip:growth=1250.5,decay=0.1,initial_population_size=60,repair_factor=1e-07"
    schedule = make_controller(
        "spsfa-tip:repair_factor=0.0000001,growth=1250.50,low_deviation=20,decay=.1,initial_population_size=60"
    )
    assert schedule.name == name
    assert SelfAdaptiveSchedule(True, np.float64(500)).name == "spsfa-tip:growth=500"
    assert make_controller("spsfa", SizeLimits(2, 50)).name == "spsfa"
    assert set(EVERY_PARAMETER) == set(parameter_ranges(SizeLimits()))


@pytest.mark.parametrize(
    ("argument", "message"),
    [
        ("omega=500", r"'omega=500'.*unknown parameter 'omega'"),
        ("growth=500,", "unknown parameter ''"),
        ("growth", "growth must be a number"),
        ("growth=much", "'growth=much'.*growth must be a number"),
        ("growth=1,decay=0.1,growth=1", "growth is given twice"),
        ("growth=-1", r"growth must lie in \[0, 1e\+06\], got -1"),
        ("growth=nan", "growth must lie"),
        ("low_deviation=inf", "low_deviation must lie"),
        ("initial_population_size=60.5", "initial_population_size must be an integer"),
        ("initial_population_size=201", r"\[2, 200\], got 201"),
        ("smallest=1", r"smallest must lie in \[2, 200\], got 1"),
    ],
)
def test_arguments_that_a_schedule_cannot_take_are_refused_with_those_it_can(argument, message):
    with pytest.raises(SettingError, match=message) as caught:
        make_controller(f"spsfa-tip:{argument}")
    for name, span in parameter_ranges(SizeLimits()).items():
        assert f"{name} {span}" in str(caught.value)


@pytest.mark.parametrize(
    ("name", "value"),
    [("growth", math.nan), ("decay", -0.1), ("low_deviation", "20"), ("initial_population_size", 500),
     ("smallest", 0), ("repair_factor", math.inf), ("decay", True)],
)  # fmt: skip
def test_parameters_out_of_range_are_refused(name, value):
    with pytest.raises(SettingError, match=f"{name} must"):
        SelfAdaptiveSchedule(**{name: value})


def test_population_first_rises_then_falls():
    sizes = run_through_environment("spsfa", "case1", 0, 60, 80)[:, 1]
    peak = int(np.argmax(sizes))
    assert 1 <= peak <= 9
    assert sizes[peak] > 90
    assert sizes[-1] < 80

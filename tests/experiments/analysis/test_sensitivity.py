"""Blinding controllers for inputs: decisions, outcomes, and what is written of them."""

import numpy as np
import pytest

from agents import make_controller
from agents.evaluation.masking import CLOCKS, Masked, clock_columns, input_names, mean_courses
from agents.evaluation.observers import decision_names, watch
from experiments.analysis.sensitivity import ALL_BUT_ITERATION, ITERATION, Sensitivity, analyse
from experiments.analysis.sensitivity_report import draw_sensitivity, paired, sensitivity_tables, write_report
from helpers.layouts import OF_SWARMS
from swarm_gym.controllers.controller import Controller
from swarm_gym.errors import UnknownNameError
from swarm_gym.observation import OBSERVATIONS
from swarm_gym.rollout import run_episodes
from swarm_gym.runs.seeds import ANALYSIS
from swarm_gym.training.config import TrainConfig

TRAINING = TrainConfig(scenarios=("case3",), initial_population_size=20)
SEEDS = ANALYSIS[:4]
COLLISION, DIVERSITY = "log(1 + E(P)) / 8", "log(1 + diversity) / 8"
NAMES = [feature.name for feature in OBSERVATIONS["rich"].features]


class Partial(Controller):
    """Looks at E(P) and the iteration only."""

    observation = "rich"
    action = "natural"
    initial_population_size = 20

    def reset(self, num_swarms, seed=0):
        pass

    def identity(self):
        return "partial"

    def act(self, observations):
        collision, time = observations[:, NAMES.index(COLLISION)], observations[:, 3]
        return np.stack([8.0 + 12.0 * collision, 0.5 * time], axis=1).astype(np.float64)


class Remembering(Controller):
    """Alternates between two sizes: decides by its own memory."""

    observation = "scaled"
    action = "natural"
    initial_population_size = 20

    def reset(self, num_swarms, seed=0):
        self.asked = 0

    def identity(self):
        return "remembering"

    def act(self, observations):
        self.asked += 1
        return np.tile([10.0 + self.asked % 2, 0.0], (len(observations), 1))


@pytest.fixture(scope="module")
def found():
    return analyse("learned:partial", Partial(), TRAINING, ("case3", "case1"), SEEDS)


def test_an_input_that_is_not_used_changes_nothing(found):
    for name in NAMES:
        if name not in (COLLISION, *CLOCKS):
            np.testing.assert_array_equal(found.changes[name], [0.0, 0.0])
            for ours, theirs in zip(found.masked[name], found.seeing, strict=True):
                np.testing.assert_array_equal(ours, theirs)


def test_the_only_input_but_the_iteration_that_is_used_changes_its_decisions_and_the_episodes(found):
    size, phi = found.changes[COLLISION]
    assert size > 0.01
    assert phi == 0.0
    assert (found.masked[COLLISION].evaluations != found.seeing.evaluations).any()
    np.testing.assert_array_equal(found.changes[ALL_BUT_ITERATION], found.changes[COLLISION])
    np.testing.assert_array_equal(found.masked[ALL_BUT_ITERATION].gap, found.masked[COLLISION].gap)


def test_the_iteration_is_taken_away_by_its_mean_over_all(found):
    size, phi = found.changes[ITERATION]
    assert size == 0.0
    time = np.arange(100) / 100
    assert phi == pytest.approx(0.5 * abs(time - time.mean()).mean(), rel=1e-5)
    assert not any(clock in found.changes for clock in CLOCKS)


def test_changes_of_the_size_are_octaves():
    controller = Partial()
    watched = watch(controller, [controller], ["case3"], SEEDS)
    courses = mean_courses(watched.seen, watched.running)
    column = NAMES.index(COLLISION)
    blind = 8.0 + 12.0 * courses[:, column, None]
    expected = abs(np.log2(watched.decided[0][..., 0] / blind)).mean()
    only = analyse("learned:partial", controller, TRAINING, ("case3",), SEEDS)
    assert only.changes[COLLISION][0] == pytest.approx(expected, rel=1e-6)


def test_blind_for_everything_is_the_same_schedule_for_every_swarm():
    watched = watch(Partial(), [], ["case3"], SEEDS)
    masked = Masked(Partial(), mean_courses(watched.seen, watched.running), range(len(NAMES)))
    sizes = run_episodes(masked, "case1", SEEDS).sizes
    assert (sizes == sizes[0]).all()
    assert np.ptp(sizes[0]) > 0


def test_what_watches_disturbs_neither_the_episodes_nor_a_memory():
    controller = Remembering()
    masked = Masked(controller, np.zeros((1, 4)), [0])
    alone = run_episodes(controller, "case3", SEEDS)
    watched = watch(
        controller, [masked, masked.__class__(controller, np.zeros((1, 4)), [])], ["case3"], SEEDS
    )
    np.testing.assert_array_equal(watched.evaluations, alone.evaluations)
    np.testing.assert_array_equal(watched.returns, alone.returns)
    for decided in watched.decided:
        np.testing.assert_array_equal(decided[..., 0].T, alone.sizes)


@pytest.mark.parametrize("name", ["spsfa-tip", "learned:three-cases/0", "open-loop:three-cases-extended"])
def test_what_is_watched_is_what_is_carried_out(name):
    controller = make_controller(name)
    watched = watch(controller, [make_controller(name)], ["case3"], SEEDS)
    episodes = run_episodes(controller, "case3", SEEDS)
    decided = watched.decided[0]
    assert decided.shape[2] == len(decision_names(controller, "firefly"))
    np.testing.assert_array_equal(np.floor(decided[..., 0].T + 0.5), episodes.sizes)
    np.testing.assert_array_equal(decided[..., 1].T, episodes.repair_degrees)
    np.testing.assert_array_equal(watched.evaluations, episodes.evaluations)
    optimum = episodes.final_fitness / (1.0 + watched.gap)
    np.testing.assert_allclose(optimum, optimum[0])


def test_a_budget_that_is_spent_ends_what_is_watched():
    watched = watch(Partial(), [Partial()], ["case3"], SEEDS, max_evaluations=1500)
    assert (watched.evaluations >= 1500).all()
    lengths = watched.running.sum(axis=0)
    assert lengths.max() == len(watched.running) < 100
    assert np.isfinite(mean_courses(watched.seen, watched.running)).all()


def test_means_are_of_episodes_that_were_running():
    seen = np.array([[[1.0], [3.0]], [[5.0], [100.0]]])
    running = np.array([[True, True], [True, False]])
    np.testing.assert_array_equal(mean_courses(seen, running), [[2.0], [5.0]])


def test_every_layout_says_which_inputs_are_the_iteration():
    for name in OF_SWARMS:
        controller = Partial()
        controller.observation = name
        assert 3 in clock_columns(controller)
        assert len(clock_columns(controller)) == (2 if name in ("rich", "priced") else 1)
    controller.observation = "paper+extended"
    assert clock_columns(controller) == [3, 7]


def test_inputs_are_named_by_their_features_and_those_of_a_base_marked():
    controller = Partial()
    assert input_names(controller) == NAMES
    paper = [feature.name for feature in OBSERVATIONS["paper"].features]
    controller.observation = "paper+rich"
    assert input_names(controller) == paper + NAMES
    controller.corrects = make_controller("spsfa")
    assert input_names(controller) == [*(f"{name} (base)" for name in paper), *NAMES]
    policy = make_controller("learned:three-cases/0")
    assert input_names(policy)[:4] == [f"{name} (base)" for name in paper]
    controller = Partial()
    controller.observation = "scaled+scaled+scaled"  # no two inputs have one name
    scaled = [feature.name for feature in OBSERVATIONS["scaled"].features]
    assert input_names(controller) == [*scaled, *(f"{n} ({k})" for k in (2, 3) for n in scaled)]
    controller.observation = "papers+rich"
    with pytest.raises(UnknownNameError, match=r"'papers'.*paper, priced"):
        input_names(controller)


def test_differences_are_paired_and_their_interval_holds_the_mean():
    differences = np.random.default_rng(0).normal(1.0, 1.0, (3, 40))
    mean, (low, high) = paired(differences)
    assert mean == differences.mean()
    half = 1.96 * differences.std() / np.sqrt(differences.size)
    assert (low, high) == pytest.approx((mean - half, mean + half), abs=0.2 * half)
    assert paired(np.ones((2, 5))) == (1.0, pytest.approx((1.0, 1.0)))


def test_the_report_has_a_row_per_input_in_every_form(found, tmp_path):
    page = write_report(found, tmp_path).read_text()
    changes, performance = sensitivity_tables(found)
    assert [row[0] for row in changes.rows] == list(found.changes)
    assert [row[0] for row in performance.rows] == ["nothing", *found.changes]
    unused = next(row for row in performance.rows if row[0] == DIVERSITY)
    assert str(unused[2]) == "+0.00 % [+0.00, +0.00]"
    for table in (changes, performance):
        assert table.markdown() in page
        assert (tmp_path / f"{table.name}.csv").exists()
        assert (tmp_path / f"{table.name}.tex").exists()
    assert (tmp_path / "figure-sensitivity.png").stat().st_size > 5000
    assert "figure-sensitivity.svg" in page


def test_the_figure_has_a_panel_per_decision_and_two_of_the_outcome(found):
    figure = draw_sensitivity(found)
    assert isinstance(found, Sensitivity)
    assert len(figure.axes) == len(found.decisions) + 2
    assert len(figure.axes[0].patches) == len(found.changes)
    widths = [patch.get_width() for patch in figure.axes[0].patches]
    np.testing.assert_allclose(widths, [row[0] for row in found.changes.values()])

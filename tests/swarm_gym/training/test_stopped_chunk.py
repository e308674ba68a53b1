"""A training that is stopped within a chunk goes on as if it had not been, and its bar moves meanwhile."""

import threading
import time

import numpy as np
import pytest
from tensorboard.backend.event_processing.event_accumulator import EventAccumulator

from helpers.trainings import DQN, EVOLUTION, STEPS, assert_same_weights, train
from swarm_gym.training import events, run
from swarm_gym.training.events import Progress

SHORT = {"iterations": 12, "warm_start": "none", "validation_seeds": 1}
GROUPS = {
    **SHORT, "critic": False, "gae_lambda": 1.0, "group_size": 2, "base": "spsfa-tip",
    "noise_steps": 0, "averaging": 0.5,
}  # fmt: skip
DEVICE = {**SHORT, "algorithm": "device-ppo"}
PAIRED = {**SHORT, "reward": "paired", "reference": "spsfa-tip:initial_population_size=4"}


class Stop(BaseException):
    """Ctrl-C, in a test."""


def scalars(folder):
    """Return all scalars of a run by name, as pairs of step and value."""
    events = EventAccumulator(str(folder), size_guidance={"scalars": 0}).Reload()
    return {
        name: [(each.step, each.value) for each in events.Scalars(name)] for name in events.Tags()["scalars"]
    }


@pytest.mark.parametrize(
    ("options", "rollout"),
    [
        ({**GROUPS, "corrected_from": 3}, 2),
        pytest.param(
            {**GROUPS, "also_on": ("particle-swarm",), "base": "fixed:6"}, 1, marks=pytest.mark.slow
        ),
        pytest.param(SHORT, 3, marks=pytest.mark.slow),
        pytest.param(PAIRED, 2, marks=pytest.mark.slow),
        pytest.param({**SHORT, "algorithm": "recurrent-ppo", "lstm_size": 4}, 2, marks=pytest.mark.slow),
        pytest.param({**SHORT, "algorithm": "choice-ppo"}, 2, marks=pytest.mark.slow),
        ({**DEVICE, "averaging": 0.5}, 2),
        pytest.param(DQN, 2, marks=pytest.mark.slow),
        pytest.param(EVOLUTION, 2, marks=pytest.mark.slow),
        pytest.param(EVOLUTION, 3, marks=pytest.mark.slow),
    ],
    ids=[
        "groups",
        "several",
        "ppo",
        "paired",
        "recurrent",
        "choices",
        "device",
        "dqn",
        "evolution",
        "evolution at the end",
    ],
)
def test_a_training_that_is_stopped_within_a_chunk_goes_on_from_there(
    tmp_path, monkeypatch, options, rollout
):
    given = {"rollouts_per_chunk": 3, "total_steps": 1, **options}
    train(tmp_path, name="whole", **given).run()
    monkeypatch.setattr(run, "BETWEEN_CHECKPOINTS", -1.0)
    stopped = train(tmp_path, name="stopped", **given)
    saves = []

    def save():
        type(stopped)._save_sometimes(stopped)
        saves.append(stopped.learner.num_steps)
        if len(saves) == rollout:
            raise Stop

    monkeypatch.setattr(stopped, "_save_sometimes", save)
    with pytest.raises(Stop):
        stopped.run()
    resumed = train(tmp_path, name="stopped", resume=True, **given)
    assert resumed.learner.num_steps == saves[-1]
    assert resumed.learner.in_chunk
    assert resumed.chunk == 0
    resumed.run()
    assert not resumed.learner.in_chunk
    for name in ("latest", "best"):
        assert_same_weights(*(tmp_path / each / f"{name}.safetensors" for each in ("whole", "stopped")))
    whole, again = scalars(tmp_path / "whole"), scalars(tmp_path / "stopped")
    assert whole.keys() == again.keys()
    for name, values in whole.items():
        if not name.startswith("time/"):
            np.testing.assert_array_equal(again[name], values, err_msg=name)


ARRIVES = "dynamic:case1-gate@3-4-drive@1,every=1,distance=120"


@pytest.mark.parametrize(
    "options",
    [
        {**SHORT, "base": "random"},
        {**DQN, **SHORT, "base": "random"},
        {**DQN, "iterations": 30, "scenarios": (ARRIVES,), "reward": "detour"},
    ],
    ids=["ppo", "dqn", "dqn of robots"],
)
def test_where_resets_do_not_lead_to_the_same_episodes_a_training_goes_on_from_whole_chunks(
    tmp_path, monkeypatch, options
):
    monkeypatch.setattr(run, "BETWEEN_CHECKPOINTS", -1.0)
    given = {"rollouts_per_chunk": 2, "validation_seeds": 1, **options}
    steps = 2 * 4 * given["iterations"]
    whole = train(tmp_path, name="whole", total_steps=2 * steps, **given)
    whole.learner.after_rollout = lambda: pytest.fail("stored within a chunk")
    monkeypatch.setattr(whole, "_save_sometimes", whole.learner.after_rollout)
    whole.run()
    train(tmp_path, name="stopped", total_steps=steps, **given).run()
    train(tmp_path, name="stopped", total_steps=2 * steps, resume=True, **given).run()
    assert_same_weights(*(tmp_path / each / "latest.safetensors" for each in ("whole", "stopped")))


def test_the_first_checkpoint_comes_before_the_first_validation(tmp_path, monkeypatch):
    stopped = train(tmp_path, **EVOLUTION)

    def stop():
        raise Stop

    monkeypatch.setattr(stopped, "_validate", stop)
    with pytest.raises(Stop):
        stopped.run()
    assert stopped.checkpoints.newest.exists()
    resumed = train(tmp_path, **EVOLUTION, resume=True, total_steps=STEPS)
    assert resumed._goes_on
    resumed.run()
    assert np.isfinite(resumed.best_return)


@pytest.mark.parametrize("options", [{"rollout_steps": 5, **SHORT}, {"max_evaluations": 900}])
def test_chunks_whose_rollouts_begin_inside_of_episodes_are_not_stopped(tmp_path, options):
    made = train(tmp_path, **options)
    assert not made.learner._stops_between_rollouts
    assert train(tmp_path, name="other").learner._stops_between_rollouts


def test_the_bar_moves_within_a_chunk(monkeypatch, capsys):
    monkeypatch.setattr(events, "PERIOD", 0.01)
    steps = [0]
    with Progress("mine", 90, lambda: steps[0]) as bar:
        for _ in range(3):
            steps[0] += 30
            deadline = time.monotonic() + 10.0
            while bar._bar.n < steps[0] and time.monotonic() < deadline:
                time.sleep(0.005)
            assert bar._bar.n == steps[0]
        with bar.during("validation"):
            bar.show(best=-1.25)
    shown = capsys.readouterr().err
    assert "mine, validation:" in shown
    assert "best=-1.250" in shown
    assert "30/90" in shown
    assert bar._thread not in threading.enumerate()


def test_the_bar_ends_with_the_training_that_is_stopped(capsys):
    with pytest.raises(Stop), Progress("mine", 10, lambda: 4) as bar:
        raise Stop
    assert not bar._thread.is_alive()
    assert "4/10" in capsys.readouterr().err

"""TensorBoard events of a training, read back as TensorBoard reads them."""

import io
import itertools
import json
import sys

import numpy as np
import pytest
from PIL import Image
from tensorboard.backend.event_processing.event_accumulator import EventAccumulator
from tensorboard.plugins.hparams.plugin_data_pb2 import HParamsPluginData

from agents import SizeLimits, make_controller
from helpers import trainings
from helpers.trainings import train
from swarm_gym.controllers.learned.policy_file import load_policy
from swarm_gym.rollout import Episodes, run_episodes
from swarm_gym.training.pictures import ReplayStrip, draw_decisions

pytest.importorskip("pygame")

STEPS = 4
EVOLUTION = {**trainings.EVOLUTION, "iterations": 7, "total_steps": 2 * STEPS * 7}


def shown(folder):
    events = EventAccumulator(str(folder), size_guidance={"images": 0, "scalars": 0})
    return events.Reload()


def pictures(events, name):
    return [
        np.asarray(Image.open(io.BytesIO(event.encoded_image_string)))
        for event in events.Images(f"validation/{name}")
    ]


def session(events):
    """Return hyperparameters and names of metrics as the HParams tab reads them."""
    content = {
        tag: HParamsPluginData.FromString(data) for tag, data in events.PluginTagToContent("hparams").items()
    }
    start = content["_hparams_/session_start_info"].session_start_info.hparams
    assert "_hparams_/session_end_info" in content
    metrics = content["_hparams_/experiment"].experiment.metric_infos
    values = {name: getattr(value, value.WhichOneof("kind")) for name, value in start.items()}
    return values, {info.name.tag for info in metrics}


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("runs")
    train(folder, name="whole", scenarios=("case3", "case1"), **EVOLUTION).run()
    return folder


def test_each_validation_leaves_a_figure_and_a_replay(folder):
    events = shown(folder / "whole")
    steps = [event.step for event in events.Scalars("validation/return")]
    assert len(steps) == 3
    for name in ("decisions", "replay"):
        assert [event.step for event in events.Images(f"validation/{name}")] == steps
    assert {picture.shape for picture in pictures(events, "decisions")} == {(344, 512, 3)}
    for picture in pictures(events, "replay"):
        frames = np.split(picture, 5, axis=1)
        assert frames[0].shape == (260, 480, 3)
        assert all((one != other).any() for one, other in itertools.pairwise(frames))
    assert all(len(e.encoded_image_string) < 300_000 for e in events.Images("validation/replay"))


def test_hyperparameters_and_what_the_best_policy_came_to_are_in_the_tab(folder):
    values, metrics = session(shown(folder / "whole"))
    assert values["algorithm"] == "evolution"
    assert values["candidates"] == 4
    assert json.loads(values["scenarios"]) == ["case3", "case1"]
    # A run may be made longer or moved, but TensorBoard keeps what it read first.
    assert not {"total_steps", "name", "runs", "resume", "threads"} & set(values)
    events = shown(folder / "whole")
    returns = [event.value for event in events.Scalars("validation/return")]
    (best,) = events.Scalars("hparam/best_return")
    assert best.value == max(returns)
    at_best = returns.index(best.value)
    for scenario in ("case3", "case1"):
        for name in ("return", "final_fitness", "evaluations"):
            (metric,) = events.Scalars(f"hparam/{scenario}/{name}")
            assert metric.value == events.Scalars(f"validation/{scenario}/{name}")[at_best].value
    assert metrics == {tag for tag in events.Tags()["scalars"] if tag.startswith("hparam/")}


def test_a_run_that_had_ended_can_be_resumed_and_is_listed_as_before(tmp_path):
    train(tmp_path, **EVOLUTION).run()
    before = shown(tmp_path / "ppo")
    train(tmp_path, resume=True, **EVOLUTION).run()
    after = shown(tmp_path / "ppo")
    assert session(after) == session(before)
    (best,) = before.Scalars("hparam/best_return")
    assert {event.value for event in after.Scalars("hparam/best_return")} == {best.value}
    for name in ("decisions", "replay"):
        assert len(after.Images(f"validation/{name}")) == len(before.Images(f"validation/{name}")) == 3


def test_without_pygame_the_same_is_learned_and_one_line_says_what_is_missing(tmp_path, monkeypatch, caplog):
    watched = load_policy(train(tmp_path, name="watched", **EVOLUTION).run())[0]
    monkeypatch.setitem(sys.modules, "pygame", None)
    unwatched = load_policy(train(tmp_path, **EVOLUTION).run())[0]
    assert all((watched[name] == unwatched[name]).all() for name in unwatched)
    (said,) = [record.getMessage() for record in caplog.records if record.name == "agents"]
    assert "no replays" in said
    assert 'pip install "swarm_gym[render]"' in said
    events = shown(tmp_path / "ppo")
    assert events.Tags()["images"] == ["validation/decisions"]
    session(events)


@pytest.mark.parametrize(
    ("options", "due"),
    [
        ({"iterations": 8}, [0, 2, 4, 6, 8]),
        ({"iterations": 3}, [0, 1, 2, 3]),
        ({"iterations": 8, "max_evaluations": 120}, [0, 2, 4, 6, 8]),
    ],
    ids=["whole", "fewer iterations than pictures", "ended early"],
)
def test_a_strip_shows_an_episode_from_its_beginning_to_its_end(options, due):
    strip, controller = ReplayStrip(), make_controller("fixed:8", SizeLimits(2, 12))
    options = {"initial_population_size": 8, "max_population_size": 12, **options}
    for _ in range(2):  # another episode begins a new strip
        sizes = run_episodes(controller, "case3", range(2), look=strip.look, **options).sizes[0]
        end = np.isfinite(sizes).sum()
        assert 2 < end <= options["iterations"]
        assert (end < options["iterations"]) == ("max_evaluations" in options)
        assert [scene.iteration for scene in strip._scenes] == [min(iteration, end) for iteration in due]
    assert strip.draw().shape == (260, 480 * len(due), 3)


def episodes(sizes, repair_degrees):
    return Episodes(*np.zeros((3, len(sizes))), sizes, repair_degrees)


def test_only_the_first_scenarios_are_drawn_where_they_are_many():
    rng = np.random.default_rng(0)
    made = {f"scenario {k}": episodes(rng.uniform(2, 99, (3, 9)), rng.uniform(size=(3, 9))) for k in range(6)}
    first, drawn = dict(list(made.items())[:4]), draw_decisions(made)
    alone = draw_decisions(first)
    # All but the title is as if there were no more of them.
    assert (drawn[40:] == alone[40:]).all()
    assert (drawn[:40] != alone[:40]).any()


def test_episodes_that_ended_count_as_long_as_they_went_on():
    sizes = np.array([[5.0, 5.0, 9.0, np.nan], [5.0, 5.0, np.nan, np.nan]])
    alone = np.array([[5.0, 5.0, 9.0], [5.0, 5.0, 9.0]])
    drawn, same = (draw_decisions({"a": episodes(values, values / 9.0)}) for values in (sizes, alone))
    assert (drawn == same).all()

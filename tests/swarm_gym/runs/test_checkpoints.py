"""Checkpoints: two are kept, damage is noticed, and events go as far as they do and no further."""

import os
import time

import pytest
from tensorboard.backend.event_processing.event_accumulator import EventAccumulator

from helpers.event_files import EVERYTHING, shown
from helpers.slow import slow_but
from helpers.small_commands import assert_same_learning
from helpers.trainings import EVOLUTION, assert_same_weights, train
from swarm_gym import files
from swarm_gym.files import remove_partials, write_atomically
from swarm_gym.runs.checkpoints import Checkpoints
from swarm_gym.runs.folder import RunFolderError
from swarm_gym.training.events import TrainingEvents

pytestmark = pytest.mark.usefixtures("plain_pictures")

LITTLE = {**EVOLUTION, "iterations": 7, "total_steps": 3 * 4 * 7}


class StoppedError(Exception):
    """In the place of a kill."""


def flip(path, place):
    content = bytearray(path.read_bytes())
    content[place] ^= 1
    path.write_bytes(content)


DAMAGE = {
    "cut": lambda path: os.truncate(path, path.stat().st_size // 2),
    "empty": lambda path: os.truncate(path, 0),
    "bit in the content": lambda path: flip(path, -1),
    "bit in the digest": lambda path: flip(path, 40),
    "bit in the format": lambda path: flip(path, 3),
    "another file": lambda path: path.write_bytes(b"PK"),
}


@pytest.fixture
def stored(tmp_path):
    found = Checkpoints(tmp_path, ".pt")
    for number in (b"one", b"two", b"th\nree"):
        found.save(number)
    return found


def test_the_newest_of_two_is_gone_on_from_where_there_is_any(stored, tmp_path, capsys):
    assert {path.name for path in tmp_path.iterdir()} == {"checkpoint.pt", "checkpoint-before.pt"}
    assert stored.load(bytes) == b"th\nree"
    assert capsys.readouterr().err == ""
    assert Checkpoints(tmp_path / "other", ".pt").load(bytes) is None


@pytest.mark.parametrize("damage", DAMAGE)
def test_a_damaged_one_is_said_and_the_one_before_is_gone_on_from(stored, capsys, damage):
    DAMAGE[damage](stored.newest)
    assert stored.load(bytes) == b"two"
    said = capsys.readouterr().err
    assert f"{stored.newest} is damaged" in said
    assert str(stored.before) in said
    assert stored.load(bytes) == b"two"
    stored.save(b"four")  # over the damaged one, which must not take the place of the one before
    DAMAGE[damage](stored.newest)
    assert stored.load(bytes) == b"two"


@pytest.mark.parametrize("damage", DAMAGE)
def test_where_both_are_damaged_both_are_named_and_kept(stored, damage):
    for path in (stored.newest, stored.before):
        DAMAGE[damage](path)
    before = [path.read_bytes() for path in (stored.newest, stored.before)]
    with pytest.raises(RunFolderError, match=r"checkpoint\.pt is damaged.*checkpoint-before\.pt is damaged"):
        stored.load(bytes)
    assert before == [path.read_bytes() for path in (stored.newest, stored.before)]
    stored.before.unlink()
    with pytest.raises(RunFolderError, match=r"checkpoint\.pt is damaged.*there is no checkpoint-before\.pt"):
        stored.load(bytes)


def test_what_is_whole_but_cannot_be_read_is_no_reason_to_go_back(stored):
    with pytest.raises(RunFolderError, match=r"checkpoint\.pt: not a readable checkpoint \(no such number\)"):
        stored.load(lambda _: (_ for _ in ()).throw(ValueError("no such number")))


@pytest.mark.parametrize("function", ["fsync", "replace"])
@pytest.mark.parametrize("call", [1, 2])
def test_stopped_at_any_point_of_writing_one_checkpoint_is_whole(stored, monkeypatch, function, call):
    true, calls = getattr(os, function), []

    def stopping(*arguments):
        calls.append(arguments)
        if len(calls) == call:
            raise StoppedError
        return true(*arguments)

    monkeypatch.setattr(files.os, function, stopping)
    with pytest.raises(StoppedError):
        stored.save(b"four")
    monkeypatch.undo()
    # The folder is synchronised last, when both files have their names.
    assert stored.load(bytes) == (b"four" if (function, call) == ("fsync", 2) else b"th\nree")
    remove_partials(stored.newest.parent)
    stored.save(b"five")
    assert stored.load(bytes) == b"five"


def test_a_file_is_on_the_disk_before_it_has_its_name_and_its_name_after(tmp_path, monkeypatch):
    done = []
    true_fsync, true_replace = os.fsync, os.replace

    def fsync(descriptor):
        done.append("folder" if os.path.isdir(f"/proc/self/fd/{descriptor}") else "file")
        true_fsync(descriptor)

    def replace(*arguments):
        done.append("name")
        true_replace(*arguments)

    monkeypatch.setattr(files.os, "fsync", fsync)
    monkeypatch.setattr(files.os, "replace", replace)
    write_atomically(tmp_path / "new" / "a", "text")
    if os.path.isdir("/proc/self/fd"):
        assert done == ["file", "name", "folder"]
    else:
        assert done.index("name") == 1


def test_what_a_killed_process_left_is_removed_when_the_run_goes_on(tmp_path):
    left = train(tmp_path, **LITTLE).folder / "checkpoint.pt.1-2.partial"
    left.write_bytes(b"half")
    train(tmp_path, **LITTLE, resume=True)
    assert not left.exists()


@pytest.mark.parametrize("hours", slow_but([-1], [-1, 1]))
def test_a_clock_that_is_set_meanwhile_does_not_matter(tmp_path, monkeypatch, capsys, hours):
    train(tmp_path, name="whole", **LITTLE).run()
    train(tmp_path, name="it", **{**LITTLE, "total_steps": LITTLE["total_steps"] // 3}).run()
    right = time.time
    monkeypatch.setattr(time, "time", lambda: right() + 3600 * hours)
    train(tmp_path, name="it", **LITTLE, resume=True).run()
    assert_same_weights(*(tmp_path / name / "best.safetensors" for name in ("whole", "it")))
    assert ("the clock was set back" in capsys.readouterr().err) is (hours < 0)


@pytest.fixture(scope="module")
def whole(tmp_path_factory, plain_pictures):
    return train(tmp_path_factory.mktemp("whole"), **LITTLE).run().parent


@pytest.mark.parametrize(
    "stop", slow_but(["_save_checkpoint"], ["_validate", "_save_checkpoint", "_write_hyperparameters"])
)
def test_a_training_that_was_stopped_shows_every_event_once(whole, tmp_path, monkeypatch, stop):
    run = train(tmp_path, **LITTLE)
    true, calls = getattr(run, stop), []

    def stopping():
        result = true()
        calls.append(stop)
        if len(calls) == (1 if stop == "_write_hyperparameters" else 2):
            raise StoppedError
        return result

    monkeypatch.setattr(run, stop, stopping)
    with pytest.raises(StoppedError):
        run.run()
    run.events.close()
    train(tmp_path, **LITTLE, resume=True).run()
    assert_same_learning(whole, run.folder)


def test_a_training_whose_newest_checkpoint_is_damaged_equals_one_that_was_not_stopped(
    whole, tmp_path, capsys
):
    run = train(tmp_path, **LITTLE)
    run.run()
    DAMAGE["bit in the content"](run.checkpoints.newest)
    capsys.readouterr()
    train(tmp_path, **LITTLE, resume=True).run()
    assert str(run.checkpoints.before) in capsys.readouterr().err
    assert_same_learning(whole, run.folder)


def test_a_training_that_is_made_longer_shows_what_a_long_one_does(whole, tmp_path):
    train(tmp_path, **{**LITTLE, "total_steps": 4 * 7}).run()
    train(tmp_path, **LITTLE, resume=True).run()
    assert shown(tmp_path / "ppo") == shown(whole)


def values(reader):
    return [(event.step, event.value) for event in reader.Scalars("a")]


def test_a_tensorboard_that_is_open_meanwhile_forgets_what_is_made_again(tmp_path):
    events = TrainingEvents(tmp_path, None)
    events.add_scalars({"a": 1.0}, 10)
    sizes = events.flush()
    events.add_scalars({"a": 2.0}, 20)
    events.close()
    reader = EventAccumulator(str(tmp_path), EVERYTHING).Reload()
    assert values(reader) == [(10, 1.0), (20, 2.0)]
    again = TrainingEvents(tmp_path, sizes, 10)
    again.add_scalars({"a": 3.0}, 20)
    again.close()
    fresh = EventAccumulator(str(tmp_path), EVERYTHING)
    assert values(reader.Reload()) == values(fresh.Reload()) == [(10, 1.0), (20, 3.0)]


def test_events_that_are_missing_are_said(tmp_path, capsys):
    events = TrainingEvents(tmp_path, None)
    events.add_scalars({"a": 1.0}, 10)
    sizes = events.flush()
    events.close()
    (name,) = sizes
    os.truncate(tmp_path / name, 9)
    TrainingEvents(tmp_path, sizes, 10).close()
    assert f"{name} has 9 of {sizes[name]} bytes" in capsys.readouterr().err

"""Swarms spread over threads."""

import threading

import numpy as np
import pytest

from helpers.loops import looped
from swarm_gym.optimizers.optimizer import spread


@looped("num_threads", [1, 2, 3, 16])
@pytest.mark.parametrize("chosen", [[], [0], [1], [1, 0, 1, 1, 0, 1, 1]])
def test_every_chosen_swarm_has_its_turn_once(num_threads, chosen):
    chosen, turns = np.array(chosen, dtype=bool), []
    spread(lambda part: turns.extend(np.flatnonzero(part)), chosen, num_threads)
    assert sorted(turns) == np.flatnonzero(chosen).tolist()


def test_parts_run_at_the_same_time_in_threads_of_their_own():
    meeting, names = threading.Barrier(3, timeout=30), set()

    def run(part):
        meeting.wait()
        names.add(threading.current_thread().name)

    spread(run, np.full(6, True), 3)
    assert len(names) == 3


@pytest.mark.parametrize("failing", [0, 5])
def test_an_error_in_a_thread_reaches_the_caller_once_all_are_done(failing):
    done = []

    def run(part):
        if part[failing]:
            raise ValueError("in a thread")
        done.append(part)

    with pytest.raises(ValueError, match="in a thread"):
        spread(run, np.full(6, True), 3)
    assert len(done) == 2

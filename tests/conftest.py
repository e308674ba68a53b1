"""Shared fixtures."""

import gc
import signal

import numba
import numpy as np
import pytest
from hypothesis import settings

pytest_plugins = ["helpers.skips", "pytester"]

# `make test-slow` asks for the thorough profile, which replaces the usual one.
settings.register_profile("usual", max_examples=40)
settings.register_profile("thorough", max_examples=10_000)
settings.load_profile("usual")


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_auto_num_workers(config):
    """Workers for `-n auto`: one more than usual, which works while others wait for processes."""
    from xdist.plugin import pytest_xdist_auto_num_workers as usual

    return 1 + usual(config)


@pytest.hookimpl(hookwrapper=True)
def pytest_collection():
    """Modules and tests live to the end: the garbage collector does not look at them again and again."""
    gc.disable()
    yield
    gc.freeze()
    gc.enable()


@pytest.fixture(scope="session", autouse=True)
def _ctrl_c_arrives():
    """Here and in commands that tests start, though shells tell what runs in the background to ignore it."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


@pytest.fixture(scope="session")
def numba_threads():
    """Return the number of threads that kernels can be spread over on this machine."""
    return numba.config.NUMBA_NUM_THREADS


@pytest.fixture
def database(tmp_path):
    """A database of results that holds nothing yet."""
    from experiments.runs.database import Results  # takes seconds, which most tests shall not wait for

    results = Results(tmp_path / "made.sqlite")
    yield results
    results.close()


@pytest.fixture(scope="module")
def little_imitation():
    """Imitation that ends before it has learned anything."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("swarm_gym.training.imitation.GRADIENT_STEPS", 20)
        yield


@pytest.fixture(scope="module")
def plain_pictures():
    """Trainings whose pictures take no time to draw, which would be most of a small training's time."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(
            "swarm_gym.training.events.draw_decisions", lambda _: np.zeros((2, 2, 3), dtype=np.uint8)
        )
        patch.setattr("swarm_gym.training.run.make_replay_strip", lambda: None)
        yield


@pytest.fixture
def window(monkeypatch):
    """Windows that no screen shows."""
    pygame = pytest.importorskip("pygame")
    monkeypatch.setenv("SDL_VIDEODRIVER", "dummy")
    pygame.display.quit()
    yield
    pygame.quit()

"""A window obeys its user, stays responsive while it waits, and delays nothing once it is closed."""

import threading
from types import SimpleNamespace

import numpy as np
import pytest

from swarm_gym.rendering.window import FASTEST, KEYS, POLL_INTERVAL, SLOWEST, Window

pygame = pytest.importorskip("pygame")
pytestmark = pytest.mark.usefixtures("window")

SIZE = (320, 240)


def picture(colour="red", size=SIZE):
    surface = pygame.Surface(size)
    surface.fill(colour)
    return surface


def press(*keys):
    """Simulate that the user presses keys, by pygame's names; the window reads them at its next look."""
    for key in keys:
        pygame.event.post(pygame.event.Event(pygame.KEYDOWN, key=pygame.key.key_code(key)))


def opened(fps=FASTEST):
    window = Window(SIZE, fps)
    window.show(picture())
    return window


def paused():
    """Return a window that waits from its next look on."""
    window = opened()
    press("space")
    return window


def shown_colour(at=(160, 120)):
    return tuple(pygame.display.get_surface().get_at(at))[:3]


@pytest.fixture
def naps_until_shown(monkeypatch):
    """Return how often a window slept until `show` returned.

    The user presses one key after each of these times. No other time passes.
    """
    slept, left = [], []

    def sleep(seconds):
        assert 0 < seconds <= POLL_INTERVAL
        slept.append(seconds)
        press(left.pop(0))

    clock = SimpleNamespace(sleep=sleep, perf_counter=lambda: sum(slept))
    monkeypatch.setattr("swarm_gym.rendering.window.time", clock)

    def naps(window, *keys):
        left[:] = keys
        before = len(slept)
        window.show(picture("blue"))
        assert left == []
        return len(slept) - before

    return naps


def test_a_window_shows_the_last_picture_and_says_its_keys():
    window = opened()
    window.show(picture("blue"))
    assert shown_colour() == (0, 0, 255)
    assert KEYS in pygame.display.get_caption()[0]
    assert not window.is_paused


def test_a_paused_window_waits_for_a_step_and_stays_paused(naps_until_shown):
    window = paused()
    for key in ("right", "n"):
        # Other keys do not end the pause; time passes only while the window sleeps.
        assert naps_until_shown(window, "a", "left", key) == 3
        assert shown_colour() == (0, 0, 255)
        assert window.is_paused
        assert "(paused)" in pygame.display.get_caption()[0]


def test_a_paused_window_goes_on_when_the_user_resumes_or_closes_it(naps_until_shown):
    window = paused()
    assert naps_until_shown(window, "right") == 1
    assert naps_until_shown(window, "space") == 1
    assert not window.is_paused
    assert "paused" not in pygame.display.get_caption()[0]
    assert naps_until_shown(window, "a") == 1  # at its speed again
    press("space")
    assert naps_until_shown(window, "a", "q") == 2
    assert pygame.display.get_surface() is None


def test_a_step_counts_for_one_picture_and_only_while_paused(naps_until_shown):
    window = opened()
    press("right", "space")  # a key for a step has no effect before the pause
    assert naps_until_shown(window, "right") == 1
    press("right", "right")  # pressed twice before the next picture
    assert naps_until_shown(window) == 0
    assert naps_until_shown(window, "right") == 1


def test_a_paused_window_is_woken_from_outside_its_thread():
    window = paused()
    resumed = threading.Event()

    def resume():
        resumed.set()
        press("space")

    timer = threading.Timer(0.2, resume)
    timer.start()
    window.show(picture())
    assert resumed.is_set()
    timer.join()


@pytest.mark.parametrize("way", ["q", "escape", "the close button"])
@pytest.mark.parametrize("paused", [True, False])
def test_a_window_that_the_user_closed_is_gone_and_waits_for_nothing(way, paused):
    window = opened()
    if paused:
        press("space")
    if way == "the close button":
        pygame.event.post(pygame.event.Event(pygame.QUIT))
    else:
        press(way)
    for _ in range(3):
        window.show(picture())
        window.respond()
        assert pygame.display.get_surface() is None
    assert window.is_dismissed
    window.close()


def test_plus_and_minus_change_the_pace_within_limits():
    window = opened(fps=FASTEST / 4)
    for key, limit in (("=", FASTEST), ("-", SLOWEST)):
        before = window.fps
        press(key)
        window.respond()
        assert window.fps == (2 * before if key == "=" else before / 2)
        for _ in range(20):
            press(key)
        window.respond()
        assert window.fps == limit


def test_a_slow_window_looks_what_its_user_does_between_two_pictures(monkeypatch):
    window, slept = opened(fps=SLOWEST), []

    def sleep(seconds):
        slept.append(seconds)
        press("q" if len(slept) == 3 else "a")

    monkeypatch.setattr("swarm_gym.rendering.window.time.sleep", sleep)
    window.show(picture())
    assert max(slept) <= POLL_INTERVAL
    assert len(slept) == 3
    assert window.is_dismissed


def test_a_window_can_have_another_size_and_shows_the_whole_picture():
    window = opened()
    pygame.display.set_mode((800, 480), pygame.RESIZABLE)
    pygame.event.post(pygame.event.Event(pygame.VIDEORESIZE, size=(800, 480), w=800, h=480))
    window.show(picture("blue"))
    assert pygame.display.get_surface().get_size() == (800, 480)
    pixels = pygame.surfarray.array3d(pygame.display.get_surface())
    columns, rows = np.nonzero((pixels == (0, 0, 255)).all(axis=-1))
    assert (np.ptp(columns) + 1, np.ptp(rows) + 1) == (640, 480)
    assert columns.min() == 80


def test_a_resized_window_is_drawn_anew_while_it_is_paused(monkeypatch):
    window = paused()

    def resize_and_resume(_):
        pygame.display.set_mode((640, 480), pygame.RESIZABLE)
        pygame.event.post(pygame.event.Event(pygame.VIDEORESIZE, size=(640, 480), w=640, h=480))
        press("space")

    monkeypatch.setattr("swarm_gym.rendering.window.time.sleep", resize_and_resume)
    window.show(picture("blue"))
    assert shown_colour((600, 440)) == (0, 0, 255)


def test_a_paused_window_does_not_wait_for_ever_when_somebody_quits_pygame(monkeypatch):
    window = paused()
    monkeypatch.setattr("swarm_gym.rendering.window.time.sleep", lambda _: pygame.quit())
    window.show(picture())
    assert pygame.display.get_surface() is None

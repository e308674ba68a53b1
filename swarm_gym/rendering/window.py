"""The window that shows pictures, and the keys of its user."""

import time
from typing import TYPE_CHECKING, Any

from swarm_gym.rendering.pen import PAPER, require_pygame

if TYPE_CHECKING:
    import pygame

TITLE = "swarm_gym"
KEYS = "space: pause, →: step, + -: faster, slower, q: close"
SLOWEST, FASTEST = 1.0, 1000.0  # pictures per second
# Interval in seconds at which a waiting window looks for input of its user.
POLL_INTERVAL = 1 / 30


class Window:
    """A window of any size that shows pictures of one size, at most `fps` per second.

    While the window is paused, `show` returns when the user asks for a single step, ends the pause or closes
    the window. Once the user has closed it, it stays closed, and nothing waits for it any more.

    Raises:
        DependencyNotInstalled: by the first picture, if pygame is missing.
    """

    def __init__(self, size: tuple[int, int], fps: float):
        self.size = size
        self.fps = fps
        self.is_paused = False
        self.is_dismissed = False
        self._may_step = False
        self._picture: pygame.Surface | None = None  # None if no window is open
        self._window_size = size
        self._shown_at = float("-inf")

    def show(self, picture: "pygame.Surface") -> None:
        """Show a picture; return when the next one is due."""
        if self.is_dismissed:
            return
        pygame = require_pygame()
        self.respond()  # reads resizing first, so that this window is not taken for another one
        if self.is_dismissed:
            return
        window = pygame.display.get_surface()
        # Pygame has one window per process, so another `Window` may have closed or resized it.
        if window is None or window.get_size() != self._window_size:
            pygame.display.set_mode(self.size, pygame.RESIZABLE)
            self._window_size = self.size
        self._picture = picture
        self._redraw()
        self._wait()

    def respond(self) -> None:
        """React to all input of the user until now."""
        if self._picture is None:
            return
        pygame = require_pygame()
        if not pygame.display.get_init():  # pygame was quit elsewhere
            return
        for event in pygame.event.get():
            if event.type == pygame.QUIT:
                self._dismiss()
                return
            if event.type == pygame.KEYDOWN:
                self._press(pygame, event.key)
            elif event.type == pygame.VIDEORESIZE:
                self._window_size = event.size
            if self.is_dismissed:
                return
            if event.type in (pygame.KEYDOWN, pygame.VIDEORESIZE, pygame.VIDEOEXPOSE):
                self._redraw()

    def close(self) -> None:
        """Close the window if anything was shown; the next picture opens another one."""
        if self._picture is not None:
            self._picture = None
            require_pygame().display.quit()

    def _press(self, pygame: Any, key: int) -> None:
        if key == pygame.K_SPACE:
            self.is_paused, self._may_step = not self.is_paused, False
        elif key in (pygame.K_RIGHT, pygame.K_n):
            self._may_step = self.is_paused
        elif key in (pygame.K_PLUS, pygame.K_EQUALS, pygame.K_KP_PLUS):
            self.fps = min(FASTEST, 2 * self.fps)
        elif key in (pygame.K_MINUS, pygame.K_KP_MINUS):
            self.fps = max(SLOWEST, self.fps / 2)
        elif key in (pygame.K_q, pygame.K_ESCAPE):
            self._dismiss()

    def _dismiss(self) -> None:
        self.close()
        self.is_dismissed = True

    def _redraw(self) -> None:
        """Show the picture as large as it fits into the window, and the state in the title."""
        pygame = require_pygame()
        window, picture = pygame.display.get_surface(), self._picture
        if window is None or picture is None:
            return
        room = window.get_rect()
        place = picture.get_rect().fit(room)
        if place.size != picture.get_size():
            picture = pygame.transform.smoothscale(picture, place.size)
        window.fill(PAPER)
        window.blit(picture, place)
        pygame.display.set_caption(f"{TITLE}{' (paused)' if self.is_paused else ''}: {KEYS}")
        pygame.display.flip()

    def _wait(self) -> None:
        """Wait until the next picture is due or, while paused, until the user asks for one."""
        pygame = require_pygame()
        while True:
            self.respond()
            if self.is_dismissed or pygame.display.get_surface() is None:
                break
            if self._may_step:
                self._may_step = False
                break
            left = POLL_INTERVAL if self.is_paused else self._shown_at + 1 / self.fps - time.perf_counter()
            if left <= 0:
                break
            time.sleep(min(left, POLL_INTERVAL))
        self._shown_at = time.perf_counter()

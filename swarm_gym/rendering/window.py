"""The window that shows pictures, and what its user can do in it."""

import time
from typing import TYPE_CHECKING, Any

from swarm_gym.rendering.pen import PAPER, require_pygame

if TYPE_CHECKING:
    import pygame

TITLE = "swarm_gym"
KEYS = "space: pause, →: step, + -: faster, slower, q: close"
SLOWEST, FASTEST = 1.0, 1000.0  # pictures per second
# How often a window that waits looks what its user does, in seconds.
POLL_INTERVAL = 1 / 30


class Window:
    """Shows pictures of one size, at most `fps` per second, in a window of any size.

    While it is paused, `show` returns for a single step, when it goes on, or when it is closed. Once the user
    has closed it, it stays closed, and nothing waits for it any more.

    Raises:
        DependencyNotInstalled: by the first picture, if pygame is missing.
    """

    def __init__(self, size: tuple[int, int], fps: float):
        self.size = size
        self.fps = fps
        self.is_paused = False
        self.is_dismissed = False
        self._may_step = False
        self._picture: pygame.Surface | None = None  # None: nothing is open
        self._window_size = size
        self._shown_at = float("-inf")

    def show(self, picture: "pygame.Surface") -> None:
        """Put a picture into the window; return when the next one is wanted."""
        if self.is_dismissed:
            return
        pygame = require_pygame()
        self.respond()  # lest a window that was resized be taken for somebody else's
        if self.is_dismissed:
            return
        window = pygame.display.get_surface()
        # Pygame has one window per process, so that another one of these may have closed or resized it.
        if window is None or window.get_size() != self._window_size:
            pygame.display.set_mode(self.size, pygame.RESIZABLE)
            self._window_size = self.size
        self._picture = picture
        self._redraw()
        self._wait()

    def respond(self) -> None:
        """React to everything that the user has done until now."""
        if self._picture is None:
            return
        pygame = require_pygame()
        if not pygame.display.get_init():  # somebody else quit pygame
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
        """Close the window, if anything was shown; the next picture opens another one."""
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
        """Show the picture as large as the window has room for, and the state in the title."""
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
        """Stay until the next picture is due, or while paused until the user asks for one."""
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

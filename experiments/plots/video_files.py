"""Videos written picture by picture, as MP4 or GIF: whole files or none."""

from abc import ABC, abstractmethod
from collections.abc import Generator
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any, Self

import numpy as np
from numpy.typing import NDArray

from swarm_gym.errors import MissingExtraError

if TYPE_CHECKING:
    from PIL import Image

Frame = NDArray[np.uint8]

# Seconds that the last picture stays.
LAST = 2.0
# Of all pictures of a GIF together; what is drawn has few, and those of smoothed edges between these.
COLOURS, EXACT_COLOURS = 128, 16


class VideoFile(ABC):
    """A file that is written inside a `with` block; after an error, or with no picture in it, there is none.

    A file that was there before stays until the new one is whole.
    """

    def __init__(self, path: Path, fps: int):
        self.path, self.fps = path, fps
        self._partial = path.with_name(f".{path.stem}.partial{path.suffix}")

    def __enter__(self) -> Self:
        """Begin, in a hidden file beside it.

        Raises:
            OSError: if there can be no such file.
            MissingExtraError: if the library is missing that writes it.
        """
        self._require_library()
        if self.path.is_dir():
            raise IsADirectoryError(f"{self.path} is a folder")
        self.path.parent.mkdir(parents=True, exist_ok=True)
        self._partial.touch()
        return self

    def __exit__(
        self, error_type: type[BaseException] | None, _: BaseException | None, __: TracebackType | None
    ) -> None:
        """Finish, or clear away what was begun."""
        try:
            self._finish(failed=error_type is not None)
            if error_type is None and self._partial.stat().st_size > 0:
                self._partial.replace(self.path)
        finally:
            self._partial.unlink(missing_ok=True)

    @abstractmethod
    def add(self, frame: Frame) -> None:
        """Go on with a picture, (height, width, 3)."""

    @abstractmethod
    def _require_library(self) -> None:
        """Refuse to begin where the library is missing."""

    @abstractmethod
    def _finish(self, failed: bool) -> None:
        """Hold the last picture, and close the file; where something failed, just close."""


class Mp4File(VideoFile):
    """H.264 by the ffmpeg that comes with imageio-ffmpeg; sides are even numbers of pixels."""

    _encoder: Generator[None, Any, None] | None = None
    _last: Frame | None = None

    def add(self, frame: Frame) -> None:
        """Go on with a picture, (height, width, 3)."""
        if self._encoder is None:
            import imageio_ffmpeg

            size = frame.shape[1::-1]
            self._encoder = imageio_ffmpeg.write_frames(
                self._partial,
                size,
                fps=self.fps,
                codec="libx264",
                macro_block_size=2,
                ffmpeg_log_level="error",
            )
            self._encoder.send(None)
        self._last = np.ascontiguousarray(frame)
        self._encoder.send(self._last)

    def _require_library(self) -> None:
        try:
            import imageio_ffmpeg  # noqa: F401
        except ImportError as error:
            raise MissingExtraError("writing an MP4", "imageio-ffmpeg", "video") from error

    def _finish(self, failed: bool) -> None:
        if self._encoder is None:
            return
        try:
            for _ in range(0 if failed else round(LAST * self.fps)):
                self._encoder.send(self._last)
        finally:
            self._encoder.close()


class GifFile(VideoFile):
    """A GIF that repeats for ever, in the colours of its first picture, whose legend shows all there are."""

    def __init__(self, path: Path, fps: int):
        super().__init__(path, fps)
        self._palette = np.empty((0, 3), dtype=np.uint8)
        self._images: list[Image.Image] = []

    def add(self, frame: Frame) -> None:
        """Go on with a picture, (height, width, 3)."""
        from PIL import Image

        if not self._images:
            self._palette = palette_of(frame)
        image = Image.fromarray(nearest(self._palette, frame))
        image.putpalette(self._palette.tobytes())
        self._images.append(image)

    def _require_library(self) -> None:
        try:
            import PIL  # noqa: F401
        except ImportError as error:
            raise MissingExtraError("writing a GIF", "Pillow", "video") from error

    def _finish(self, failed: bool) -> None:
        if failed or not self._images:
            return
        first, *others = self._images
        durations = [1000.0 / self.fps] * len(others) + [1000.0 * LAST]
        first.save(
            self._partial, save_all=True, append_images=others, duration=durations, loop=0, optimize=True
        )


def palette_of(frame: Frame) -> Frame:
    """(k, 3) the most frequent colours of a picture, then again and again the one farthest from those.

    So a thin line of its own colour keeps it, which a palette by frequency alone would not give it.
    """
    packed, counts = np.unique(_packed(frame), return_counts=True)
    colours = _unpacked(packed[np.argsort(-counts, kind="stable")])
    chosen = list(range(min(EXACT_COLOURS, len(colours))))
    distance = _distances(colours, colours[chosen]).min(axis=1)
    while len(chosen) < min(COLOURS, len(colours)):
        chosen.append(int(distance.argmax()))
        distance = np.minimum(distance, _distances(colours, colours[chosen[-1:]])[:, 0])
    return colours[chosen].astype(np.uint8)


def nearest(palette: Frame, frame: Frame) -> Frame:
    """(height, width) the number in a palette (k, 3) that is nearest to each pixel, which Pillow guesses."""
    packed, where = np.unique(_packed(frame), return_inverse=True)
    numbers = _distances(_unpacked(packed), palette.astype(np.int64)).argmin(axis=1)
    return numbers.astype(np.uint8)[where].reshape(frame.shape[:2])


def _packed(frame: Frame) -> NDArray[np.uint32]:
    """A number for each colour."""
    return frame.astype(np.uint32) @ np.array([1 << 16, 1 << 8, 1], dtype=np.uint32)


def _unpacked(packed: NDArray[np.uint32]) -> NDArray[np.int64]:
    return np.stack([packed >> 16, packed >> 8 & 255, packed & 255], axis=-1).astype(np.int64)


def _distances(colours: NDArray[np.int64], palette: NDArray[np.int64]) -> NDArray[np.int64]:
    """(n, k) squared distances between colours (n, 3) and those of a palette (k, 3)."""
    return ((colours[:, None] - palette) ** 2).sum(axis=-1)


# By how names of files end.
VIDEO_FILES: dict[str, type[VideoFile]] = {".gif": GifFile, ".mp4": Mp4File}

"""Writers of video files, MP4 and GIF, which take one picture at a time and leave whole files or none."""

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

Picture = NDArray[np.uint8]  # (height, width, 3)

# Seconds for which the last picture is shown.
LAST = 2.0
# Numbers of colours of a GIF. Shapes have few colours, which are kept exactly; smoothed edges have mixtures.
COLOURS, EXACT_COLOURS = 128, 16


class VideoFile(ABC):
    """A video file that is written inside a `with` block.

    After an error, or if no picture was added, no new file is left. An older file of that name stays until
    the new one is complete.

    Args:
        path: file to write.
        fps: pictures per second.
    """

    def __init__(self, path: Path, fps: int):
        self.path, self.fps = path, fps
        self._partial = path.with_name(f".{path.stem}.partial{path.suffix}")

    def __enter__(self) -> Self:
        """Begin a hidden file in the same folder.

        Raises:
            OSError: if the file cannot be written.
            MissingExtraError: if the library that writes it is missing.
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
        """Finish the file, or delete what was begun."""
        try:
            self._finish(failed=error_type is not None)
            if error_type is None and self._partial.stat().st_size > 0:
                self._partial.replace(self.path)
        finally:
            self._partial.unlink(missing_ok=True)

    @abstractmethod
    def add(self, picture: Picture) -> None:
        """Add a picture, (height, width, 3), all of the same size."""

    @abstractmethod
    def _require_library(self) -> None:
        """Raise MissingExtraError if the library is missing."""

    @abstractmethod
    def _finish(self, failed: bool) -> None:
        """Repeat the last picture and close the file; after a failure, only close it."""


class Mp4File(VideoFile):
    """An MP4 file, H.264 by the ffmpeg of imageio-ffmpeg; width and height must be even."""

    _encoder: Generator[None, Any, None] | None = None
    _last: Picture | None = None

    def add(self, picture: Picture) -> None:
        """Add a picture, (height, width, 3), all of the same size."""
        if self._encoder is None:
            import imageio_ffmpeg

            size = picture.shape[1::-1]
            self._encoder = imageio_ffmpeg.write_frames(
                self._partial,
                size,
                fps=self.fps,
                codec="libx264",
                macro_block_size=2,
                ffmpeg_log_level="error",
            )
            self._encoder.send(None)
        self._last = np.ascontiguousarray(picture)
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
    """A GIF file that repeats for ever, in the colours of its first picture, whose legend has all of them."""

    def __init__(self, path: Path, fps: int):
        super().__init__(path, fps)
        self._palette = np.empty((0, 3), dtype=np.uint8)
        self._images: list[Image.Image] = []

    def add(self, picture: Picture) -> None:
        """Add a picture, (height, width, 3), all of the same size."""
        from PIL import Image

        if not self._images:
            self._palette = palette_of(picture)
        image = Image.fromarray(nearest(self._palette, picture))
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


def palette_of(picture: Picture) -> Picture:
    """Return a palette, (k, 3): the most frequent colours, then again and again the one farthest from these.

    So a thin line keeps its colour, which would be missing in a palette by frequency alone.
    """
    packed, counts = np.unique(_packed(picture), return_counts=True)
    colours = _unpacked(packed[np.argsort(-counts, kind="stable")])
    chosen = list(range(min(EXACT_COLOURS, len(colours))))
    distance = _distances(colours, colours[chosen]).min(axis=1)
    while len(chosen) < min(COLOURS, len(colours)):
        chosen.append(int(distance.argmax()))
        distance = np.minimum(distance, _distances(colours, colours[chosen[-1:]])[:, 0])
    return colours[chosen].astype(np.uint8)


def nearest(palette: Picture, picture: Picture) -> Picture:
    """Return for each pixel the row of a palette, (k, 3), that is nearest, (height, width).

    Pillow only approximates the nearest colour.
    """
    packed, where = np.unique(_packed(picture), return_inverse=True)
    numbers = _distances(_unpacked(packed), palette.astype(np.int64)).argmin(axis=1)
    return numbers.astype(np.uint8)[where].reshape(picture.shape[:2])


def _packed(picture: Picture) -> NDArray[np.uint32]:
    """Return one integer for each colour."""
    return picture.astype(np.uint32) @ np.array([1 << 16, 1 << 8, 1], dtype=np.uint32)


def _unpacked(packed: NDArray[np.uint32]) -> NDArray[np.int64]:
    """Return the colours, (..., 3), of such integers."""
    return np.stack([packed >> 16, packed >> 8 & 255, packed & 255], axis=-1).astype(np.int64)


def _distances(colours: NDArray[np.int64], palette: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return squared distances, (n, k), between colours, (n, 3), and those of a palette, (k, 3)."""
    return ((colours[:, None] - palette) ** 2).sum(axis=-1)


# Kinds of files by the endings of their names.
VIDEO_FILES: dict[str, type[VideoFile]] = {".gif": GifFile, ".mp4": Mp4File}

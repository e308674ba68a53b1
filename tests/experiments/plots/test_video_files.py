"""Video files have the pictures they were given, and are there whole or not at all."""

import sys

import numpy as np
import pytest

from experiments.plots.video_files import LAST, VIDEO_FILES, GifFile, Mp4File, nearest
from swarm_gym.errors import MissingExtraError
from swarm_gym.rendering import pen

image = pytest.importorskip("PIL.Image")
imageio_ffmpeg = pytest.importorskip("imageio_ffmpeg")

SIZE = (320, 240)


def frames(count):
    """Pictures of a dark square that moves on by ten pixels, on a light ground."""
    made = np.full((count, *SIZE[::-1], 3), 240, dtype=np.uint8)
    for k in range(count):
        made[k, 100:140, 10 * k : 10 * k + 40] = 20
    return made


def read_gif(path):
    """Pictures, (k, height, width, 3), and how long each of them stays, in seconds."""
    with image.open(path) as gif:
        pictures, durations = [], []
        for k in range(gif.n_frames):
            gif.seek(k)
            pictures.append(np.asarray(gif.convert("RGB")))
            durations.append(gif.info["duration"] / 1000)
    return np.array(pictures), np.array(durations)


def read_mp4(path):
    """Pictures, (k, height, width, 3), and how many of them are in a second."""
    reader = imageio_ffmpeg.read_frames(str(path))
    about = next(reader)
    width, height = about["size"]
    pictures = [np.frombuffer(data, np.uint8).reshape(height, width, 3) for data in reader]
    return np.array(pictures), about["fps"]


def written(path, pictures, fps=10):
    with VIDEO_FILES[path.suffix](path, fps) as file:
        for picture in pictures:
            file.add(picture)
    return path


def test_an_mp4_has_all_pictures_and_holds_the_last_one(tmp_path):
    given = frames(5)
    pictures, fps = read_mp4(written(tmp_path / "a.mp4", given))
    assert fps == 10
    assert pictures.shape == (5 + LAST * fps, *SIZE[::-1], 3)
    assert np.abs(pictures[:5].astype(int) - given).mean() < 3
    assert np.abs(pictures[-1].astype(int) - given[-1]).mean() < 3


def test_a_gif_has_all_pictures_and_holds_the_last_one(tmp_path):
    given = frames(5)
    pictures, durations = read_gif(written(tmp_path / "a.gif", given))
    np.testing.assert_array_equal(pictures, given)
    np.testing.assert_allclose(durations, [0.1] * 4 + [LAST])
    with image.open(tmp_path / "a.gif") as gif:
        assert gif.info["loop"] == 0  # it repeats for ever


def test_a_gif_grows_with_what_changes_and_not_with_its_pictures(tmp_path):
    noise = 50 * np.random.default_rng(0).integers(0, 5, (*SIZE[::-1], 3), dtype=np.uint8)
    moving = np.repeat(noise[None], 20, axis=0)
    for k, picture in enumerate(moving):
        picture[10:20, 10 * k : 10 * k + 10] = 0
    one, many = (written(tmp_path / f"{k}.gif", moving[:k]).stat().st_size for k in (1, 20))
    assert many < 2 * one


def test_pictures_that_are_the_same_all_count_in_time(tmp_path):
    _, durations = read_gif(written(tmp_path / "a.gif", np.repeat(frames(1), 5, axis=0)))
    assert durations.sum() == pytest.approx(0.4 + LAST)


@pytest.mark.parametrize("suffix", VIDEO_FILES)
def test_the_same_pictures_give_the_same_bytes(tmp_path, suffix):
    first, second = (written(tmp_path / f"{name}{suffix}", frames(3)).read_bytes() for name in "ab")
    assert first == second


@pytest.mark.parametrize("suffix", VIDEO_FILES)
def test_after_an_error_the_file_that_was_there_is_there_and_nothing_else(tmp_path, suffix):
    path = tmp_path / f"a{suffix}"
    path.write_text("before")

    def break_down():
        with VIDEO_FILES[suffix](path, 10) as file:
            file.add(frames(1)[0])
            raise RuntimeError("in the midst")

    with pytest.raises(RuntimeError, match="in the midst"):
        break_down()
    assert path.read_text() == "before"
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize("suffix", VIDEO_FILES)
def test_no_picture_makes_no_file_folders_are_made_and_a_folder_is_no_file(tmp_path, suffix):
    written(tmp_path / f"a{suffix}", [])
    assert list(tmp_path.iterdir()) == []
    path = tmp_path / "new" / f"a{suffix}"
    written(path, frames(2))
    assert path.stat().st_size > 0
    (tmp_path / f"folder{suffix}").mkdir()
    with pytest.raises(IsADirectoryError, match="folder"):
        written(tmp_path / f"folder{suffix}", frames(2))
    with pytest.raises(OSError, match="a"):
        written(path / f"below-a-file{suffix}", frames(2))


@pytest.mark.parametrize(
    ("kind", "module", "library"), [(Mp4File, "imageio_ffmpeg", "imageio-ffmpeg"), (GifFile, "PIL", "Pillow")]
)
def test_a_missing_library_says_what_to_install_before_anything_is_written(
    tmp_path, monkeypatch, kind, module, library
):
    monkeypatch.setitem(sys.modules, module, None)
    with pytest.raises(MissingExtraError, match=rf"{library}.*swarm_gym\[video\]"), kind(tmp_path / "a", 10):
        pass
    assert list(tmp_path.iterdir()) == []


def test_the_nearest_colour_is_the_nearest():
    generator = np.random.default_rng(0)
    palette, frame = (generator.integers(0, 256, shape).astype(np.uint8) for shape in ((9, 3), (6, 7, 3)))
    found = nearest(palette, frame)
    distance = np.linalg.norm(frame[:, :, None].astype(float) - palette, axis=-1)
    np.testing.assert_allclose(
        np.take_along_axis(distance, found[..., None].astype(int), -1)[..., 0], distance.min(axis=-1)
    )


def test_a_thin_line_in_a_gif_keeps_its_colour(tmp_path):
    drawn = np.random.default_rng(0).normal(200, 20, (*SIZE[::-1], 1)).clip(0, 255).astype(np.uint8)
    given = np.repeat(drawn, 3, axis=2)
    for k, colour in enumerate([pen.FEASIBLE, pen.COLLIDING, pen.START, pen.TARGET, pen.BEST]):
        given[20 * k + 10, 20:40] = colour
    pictures, _ = read_gif(written(tmp_path / "a.gif", [given, given[::-1]]))
    assert np.abs(pictures.astype(int) - [given, given[::-1]]).max() <= 3

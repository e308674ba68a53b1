"""`python -m experiments.video` films an episode; Gymnasium's RecordVideo films every environment."""

import gymnasium
import numpy as np
import pytest
from test_video_files import image, read_gif, read_mp4

import swarm_gym  # noqa: F401
from experiments import video
from experiments.plots.video_files import LAST
from experiments.video import VideoConfig, main, write_video
from swarm_gym.errors import SettingError, UnknownNameError
from swarm_gym.optimizers import ALL_OPTIMIZERS, OPTIMIZERS
from swarm_gym.registration import environment_id

pytest.importorskip("pygame")

SMALL = {"controller": "fixed:6", "iterations": 3, "width": 400, "height": 300}
RENDERED = {"iterations": 3, "initial_population_size": 6, "render_mode": "rgb_array", "render_width": 400,
            "render_height": 300}  # fmt: skip


def test_every_iteration_is_a_picture_from_the_first_population_on(tmp_path, capsys):
    files = (tmp_path / "a.mp4", tmp_path / "a.gif")
    write_video(VideoConfig(files, **SMALL, seed=5, fps=10))
    assert sorted(tmp_path.iterdir()) == sorted(files)
    assert "filming" in capsys.readouterr().err
    pictures, fps = read_mp4(files[0])
    assert fps == 10
    assert pictures.shape == (4 + LAST * fps, 300, 400, 3)
    still, durations = read_gif(files[1])
    assert still.shape == (4, 300, 400, 3)
    np.testing.assert_allclose(durations, [0.1, 0.1, 0.1, LAST])

    env = gymnasium.make("swarm_gym/Firefly-v0", scenario="case2", **RENDERED)
    env.reset(seed=5)
    for k in range(4):
        expected = env.render().astype(int)
        assert np.abs(still[k] - expected).mean() < 1
        assert np.abs(pictures[k] - expected).mean() < 4
        if k < 3:
            env.step(np.array([6.0, 0.0]))


def test_the_same_seed_gives_the_same_film_and_another_one_does_not(tmp_path):
    films = []
    for name, seed in (("a", 1), ("b", 1), ("c", 2)):
        write_video(VideoConfig((tmp_path / f"{name}.gif",), **SMALL, seed=seed))
        films.append((tmp_path / f"{name}.gif").read_bytes())
    assert films[0] == films[1] != films[2]


def test_an_entrant_can_say_its_optimizer_and_iterations(tmp_path):
    config = VideoConfig(
        (tmp_path / "a.gif",), **{**SMALL, "controller": "firefly(2)+spsfa", "iterations": None}
    )
    write_video(config)
    with image.open(tmp_path / "a.gif") as gif:
        assert gif.n_frames == 3


def test_when_filming_fails_no_file_is_left(tmp_path, monkeypatch):
    def film(*_):
        yield np.zeros((300, 400, 3), np.uint8)
        raise RuntimeError("in the midst")

    monkeypatch.setattr(video, "film", film)
    with pytest.raises(RuntimeError, match="in the midst"):
        write_video(VideoConfig((tmp_path / "a.mp4", tmp_path / "a.gif"), **SMALL))
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("options", "error", "message"),
    [
        ({"output": ["a.avi"]}, UnknownNameError, r"kind of video file '.avi'; valid: .gif, .mp4"),
        ({"output": []}, SettingError, "each once"),
        ({"output": ["a.gif", "a.gif"]}, SettingError, "each once"),
        ({"width": 401}, SettingError, "width must be even, got 401"),
        ({"height": 100}, SettingError, r"height must lie in \[240, 4096\], got 100"),
        ({"fps": 0}, SettingError, r"fps must lie in \[1, 50\], got 0"),
        ({"seed": -1}, SettingError, "seed must lie in .*, got -1"),
        ({"iterations": 0}, SettingError, "iterations must lie in .*, got 0"),
        ({"controller": "nobody"}, UnknownNameError, "unknown controller 'nobody'; valid: .*29 in all"),
        ({"controller": "fixed:none"}, ValueError, "expected a population size"),
        ({"scenario": "nowhere"}, UnknownNameError, "unknown scenario 'nowhere'; valid: .*docs/scenarios.md"),
    ],
)
def test_what_cannot_be_filmed_is_refused_and_nothing_is_written(tmp_path, options, error, message):
    options = {"output": ["a.mp4"], **SMALL, **options}
    paths = tuple(tmp_path / name for name in options.pop("output"))
    with pytest.raises(error, match=message):
        write_video(VideoConfig(paths, **options))
    assert list(tmp_path.iterdir()) == []


def test_the_command_line_says_errors_without_a_traceback(tmp_path, monkeypatch):
    monkeypatch.setattr("sys.argv", ["video", "--output", str(tmp_path / "a.webm")])
    with pytest.raises(SystemExit, match=r"^error: unknown kind of video file '\.webm'"):
        main()


# That of the first is compiled for other tests anyway; all record alike.
@pytest.mark.parametrize(
    "optimizer",
    [pytest.param(name, marks=pytest.mark.slow if k else ()) for k, name in enumerate(OPTIMIZERS)],
)
@pytest.mark.filterwarnings("ignore:.*overwriting existing videos:UserWarning")
def test_record_video_films_every_environment(tmp_path, optimizer):
    pytest.importorskip("moviepy")
    env = gymnasium.make(environment_id(optimizer), **RENDERED)
    env = gymnasium.wrappers.RecordVideo(env, str(tmp_path), episode_trigger=lambda episode: episode == 1)
    for seed in (1, 2):
        env.reset(seed=seed)
        while not env.step(np.array([6.0, 0.0]))[2]:
            pass
    env.close()
    (file,) = tmp_path.iterdir()
    pictures, fps = read_mp4(file)
    assert pictures.shape == (4, 300, 400, 3)
    assert fps == env.metadata["render_fps"]
    assert np.abs(pictures[-1].astype(int) - pictures[0]).max() > 50


def test_the_test_above_lists_all_that_is_registered():
    ours = {name for name in gymnasium.registry if name.startswith("swarm_gym/")}
    assert ours == {environment_id(name) for name in ALL_OPTIMIZERS}

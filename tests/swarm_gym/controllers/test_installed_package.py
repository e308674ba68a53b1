"""The installed package alone is enough to control an environment: no checkout, no agents, no torch."""

import subprocess
import sys
import tomllib
import zipfile
from pathlib import Path

import pytest

CHECKOUT = Path(__file__).parents[3]
DRIVE = """
import sys
sys.path.insert(0, sys.argv[1])
for missing in ("agents", "experiments", "torch"):  # an import raises ImportError
    sys.modules[missing] = None
import gymnasium
import swarm_gym
from swarm_gym.controllers import make_controller
assert swarm_gym.__file__.startswith(sys.argv[1]), swarm_gym.__file__
for name in ("spsfa-tip", "learned:three-cases/0@1", "open-loop:dynamic-long@1", "tuned:three-cases",
             "distilled:three-cases"):
    controller = make_controller(name)
    env = gymnasium.make("swarm_gym/Firefly-v0", scenario="case3", iterations=3, **controller.env_options())
    observation, info = env.reset(seed=0)
    controller.reset(1)
    ended = False
    while not ended:
        observation, _, ended, _, info = env.step(controller.act(observation[None])[0])
    print(name, info["best_fitness"])
try:
    make_controller("learned:ablation-all/0")
except ValueError as error:
    assert "experiments/studies/learned/data/policies" in str(error), error
    print("of the laboratory")
"""

TRAIN_AND_COMPARE = """
import sys
sys.path.insert(0, sys.argv[1])
for missing in ("agents", "experiments"):  # an import raises ImportError
    sys.modules[missing] = None
from swarm_gym.__main__ import main
policy, rule = "learned:runs/mine/latest.safetensors@1", "tuned:runs/tuned/schedule.json"
tiny = "--num-swarms 16 --batch-size 340 --epochs 1 --rollouts-per-chunk 1 --validation-seeds 2".split()
for command in (
    ["train", "--name", "mine", *tiny, "--total-steps", "1360"],
    ["train", "--name", "mine", *tiny, "--total-steps", "2720", "--resume"],
    ["tune", "--name", "tuned", "--what", "schedule", "--total-steps", "900", "--episodes", "3"],
    ["compare", "spsfa-tip", policy, rule, "--scenarios", "case3", "--seeds", "2"],
    ["plan", "--map", "case2", "--budget", "300", "--output", "path.csv"],
):
    try:
        main(command)
    except SystemExit as ended:
        assert not ended.code, (command, ended.code)
"""


def test_controllers_do_not_import_torch():
    code = (
        "import sys, swarm_gym.controllers as c; c.make_controller('learned:three-cases/0@1'); "
        "assert not {'torch', 'stable_baselines3', 'matplotlib', 'agents'} & set(sys.modules)"
    )
    subprocess.run([sys.executable, "-c", code], cwd=CHECKOUT, check=True)


def test_every_packaged_file_is_package_data():
    """Each file below swarm_gym is Python, or matches a pattern of `package-data`."""
    configuration = tomllib.loads((CHECKOUT / "pyproject.toml").read_text())
    package = CHECKOUT / "swarm_gym"
    patterns = configuration["tool"]["setuptools"]["package-data"]["swarm_gym"]
    covered = {path for pattern in patterns for path in package.glob(pattern)}
    files = {path for path in package.rglob("*") if path.is_file() and "__pycache__" not in path.parts}
    assert {path for path in files - covered if path.suffix != ".py"} == set()
    assert len([path for path in covered if path.suffix == ".safetensors"]) > 20


@pytest.fixture(scope="module")
def installed(tmp_path_factory):
    """Build a wheel and unpack it; return the folder."""
    folder = tmp_path_factory.mktemp("wheel")
    source, built, installed = folder / "source", folder / "built", folder / "installed"
    source.mkdir()
    for name in ("swarm_gym", "pyproject.toml", "README.md", "LICENSE"):
        (source / name).symlink_to(CHECKOUT / name)
    subprocess.run(
        [sys.executable, "-m", "pip", "wheel", str(source), "--no-deps", "--no-build-isolation", "--quiet",
         "--wheel-dir", str(built)],
        check=True,
    )  # fmt: skip
    (wheel,) = built.glob("*.whl")
    with zipfile.ZipFile(wheel) as archive:
        archive.extractall(installed)
    return installed


def output_of(code, installed, folder):
    """Run code in a process that sees only the unpacked wheel and the libraries; return what it printed."""
    done = subprocess.run(
        [sys.executable, "-I", "-c", code, str(installed)],
        cwd=folder, capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.mark.slow
def test_a_wheel_alone_controls_an_environment(installed, tmp_path):
    assert {path.name for path in installed.iterdir() if path.suffix != ".dist-info"} == {"swarm_gym"}
    assert len(output_of(DRIVE, installed, tmp_path).splitlines()) == 6


@pytest.mark.slow
def test_a_wheel_alone_trains_resumes_tunes_compares_and_plans(installed, tmp_path):
    printed = output_of(TRAIN_AND_COMPARE, installed, tmp_path)
    assert printed.count("use it as controller learned:") == 2
    assert "objective at price 1" in printed
    assert (tmp_path / "path.csv").is_file()

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


@pytest.mark.slow
def test_a_wheel_alone_controls_an_environment(tmp_path):
    """Build a wheel, unpack it, and run controllers in a process that sees only it and the libraries."""
    source = tmp_path / "source"
    source.mkdir()
    for name in ("swarm_gym", "pyproject.toml", "README.md", "LICENSE"):
        (source / name).symlink_to(CHECKOUT / name)
    built, installed, elsewhere = tmp_path / "built", tmp_path / "installed", tmp_path / "elsewhere"
    elsewhere.mkdir()
    subprocess.run(
        [sys.executable, "-m", "pip", "wheel", str(source), "--no-deps", "--no-build-isolation", "--quiet",
         "--wheel-dir", str(built)],
        check=True,
    )  # fmt: skip
    (wheel,) = built.glob("*.whl")
    with zipfile.ZipFile(wheel) as archive:
        archive.extractall(installed)
    assert {path.name for path in installed.iterdir() if path.suffix != ".dist-info"} == {"swarm_gym"}
    done = subprocess.run(
        [sys.executable, "-I", "-c", DRIVE, str(installed)],
        cwd=elsewhere, capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert len(done.stdout.splitlines()) == 6

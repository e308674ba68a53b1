"""Ids in Gymnasium's registry: registered once, and found by processes that start anew."""

import subprocess
import sys
import warnings
from pathlib import Path

import gymnasium

from swarm_gym.optimizers import OPTIMIZERS
from swarm_gym.registration import environment_id, register_environments

ROOT = Path(__file__).parents[2]


def test_environments_are_registered_once():
    before = dict(gymnasium.registry)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        register_environments()
    assert dict(gymnasium.registry) == before
    assert {environment_id(name) for name in OPTIMIZERS} <= set(before)


def test_a_process_that_imports_gymnasium_alone_finds_an_id_with_its_package():
    code = "import gymnasium; print(gymnasium.make('swarm_gym:swarm_gym/Firefly-v0').spec.id)"
    printed = subprocess.check_output([sys.executable, "-c", code], cwd=ROOT, text=True)
    assert printed == "swarm_gym/Firefly-v0\n"

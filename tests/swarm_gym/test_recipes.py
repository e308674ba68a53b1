"""The scripts of docs/recipes.md run as they stand there."""

import importlib
import re
from pathlib import Path

import numpy as np
import pytest

PAGE = (Path(__file__).parents[2] / "docs" / "recipes.md").read_text()
SCRIPTS = dict(re.findall(r"`(\w+\.py)`:\n\n```python\n(.*?)```", PAGE, re.DOTALL))
pytest.importorskip("torch", reason="needs the extra `study`")


def test_every_script_of_the_page_is_tried():
    assert sorted(SCRIPTS) == ["ppo.py", "residual_ppo.py", "rllib_ppo.py", "tune.py"]
    assert PAGE.count("```python") == len(SCRIPTS)


@pytest.mark.slow
def test_ppo_in_one_file_learns_in_the_native_vector(capsys):
    names = {}
    exec(SCRIPTS["ppo.py"], names)
    lines = capsys.readouterr().out.splitlines()
    assert [line.partition(":")[0] for line in lines] == ["update 0", "update 1", "update 2"]
    assert np.isfinite([float(number) for number in re.findall(r"-?\d+\.\d{3}", " ".join(lines))]).all()
    assert len(names["found"]) == names["NUM_ENVS"]
    assert all(weight.grad is not None for weight in names["weights"])


def test_ppo_corrects_a_controller_in_groups(capsys):
    names = {}
    exec(SCRIPTS["residual_ppo.py"], names)
    lines = capsys.readouterr().out.splitlines()
    assert [line.partition(":")[0] for line in lines] == ["update 0", "update 1", "update 2"]
    assert np.isfinite([float(number) for number in re.findall(r"-?\d+\.\d{3}", " ".join(lines))]).all()
    assert all(layer.abs().max() > 0 for layer in names["actor"][-1].parameters())  # they were zero


def test_optuna_tunes_the_numbers_of_the_schedule(capsys):
    pytest.importorskip("optuna", reason="needs the extra `study`")
    exec(SCRIPTS["tune.py"], {})
    paper, best, name = re.fullmatch(
        r"paper (.*), best (.*): (spsfa-tip:.*)\n", capsys.readouterr().out
    ).groups()
    assert 0.0 < float(best) <= float(paper)
    assert name.count("=") == 3


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore")
def test_rllib_trains_on_an_environment(capsys):
    try:
        importlib.import_module("ray.rllib.algorithms.ppo")
    except ImportError:
        pytest.skip("needs ray[rllib], in an environment of its own; see docs/recipes.md")
    names = {}
    try:
        exec(SCRIPTS["rllib_ppo.py"], names)
    finally:
        importlib.import_module("ray").shutdown()
    lines = re.findall(r"^training (\d): (\d+) episodes, return (.*)$", capsys.readouterr().out, re.MULTILINE)
    assert [(int(number), int(episodes)) for number, episodes, _ in lines] == [(0, 20), (1, 20)]
    assert np.isfinite([float(found) for _, _, found in lines]).all()

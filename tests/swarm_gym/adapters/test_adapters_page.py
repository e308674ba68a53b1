"""The examples of docs/adapters.md and docs/adapters-problems.md run as they stand there."""

import re
import sys
from pathlib import Path

import numpy as np
import pytest

from helpers.adapted import ADAPTED, missing
from swarm_gym.env import SwarmEnv
from swarm_gym.errors import SettingError
from swarm_gym.testing import check_optimizer

DOCS = Path(__file__).parents[3] / "docs"
PAGE = "\n".join((DOCS / f"{name}.md").read_text() for name in ("adapters", "adapters-problems"))
FILES = dict(re.findall(r"`(my_swarms/\w+\.py)`:\n\n```python\n(.*?)```", PAGE, re.DOTALL))
BLOCKS = re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)


@pytest.fixture
def my_swarms(tmp_path, monkeypatch):
    """Write the files of the page, where `my_swarms` is imported from."""
    for name, code in FILES.items():
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text(code)
    monkeypatch.syspath_prepend(tmp_path)
    for name in [name for name in sys.modules if name.split(".")[0] == "my_swarms"]:
        monkeypatch.delitem(sys.modules, name)


def test_the_page_lists_the_algorithms_that_there_are():
    listed = re.findall(r"^\| `(swarm_gym\.adapters\.\w+:\w+)` \|", PAGE, re.MULTILINE)
    assert listed == [f"swarm_gym.adapters.{name}:{cls}" for name, found in ADAPTED.items() for cls in found]


@pytest.mark.parametrize("library", [pytest.param("pymoo", marks=missing("pymoo"))])
def test_the_first_example_prints_what_was_found(library, capsys):
    exec(BLOCKS[0], {})
    best, evaluations, gap = capsys.readouterr().out.split()
    assert 299.0 < float(best) < 600.0
    assert int(evaluations) > 80
    assert 0.0 < float(gap) < 1.0


@pytest.mark.parametrize("library", [pytest.param("ioh", marks=missing("ioh", "benchmarks"))])
@pytest.mark.parametrize("other", [pytest.param("pymoo", marks=missing("pymoo"))])
def test_the_example_of_ioh_prints_one_count_twice_and_logs_the_run(
    library, other, capsys, tmp_path, monkeypatch
):
    monkeypatch.chdir(tmp_path)
    names = {}
    exec(next(block for block in BLOCKS if "import ioh" in block), names)
    names["problem"].detach_logger()
    best, evaluations, counted = capsys.readouterr().out.split()
    assert float(best) > 0.0
    assert 80 < int(evaluations) == int(counted)
    assert list((tmp_path / "ioh_logs").rglob("*.dat"))


@pytest.mark.parametrize("library", [pytest.param("dacbench", marks=missing("dacbench", "dacbench"))])
@pytest.mark.filterwarnings("ignore")
def test_the_example_of_dacbench_prints_three_returns(library, capsys):
    exec(next(block for block in BLOCKS if library in block), {})
    assert len(eval(capsys.readouterr().out.splitlines()[-1], {"np": np})) == 3


@pytest.mark.usefixtures("my_swarms")
def test_another_library_is_adapted_in_a_few_lines():
    check_optimizer("my_swarms.steps:RandomSteps")


@pytest.mark.usefixtures("my_swarms")
@pytest.mark.parametrize("library", [pytest.param("pymoo", marks=missing("pymoo"))])
def test_another_algorithm_of_a_library_is_adapted_in_a_few_lines(library):
    name = "my_swarms.de:DifferentialEvolution"
    with pytest.raises(SettingError, match="min_population_size must lie in \\[4"):
        SwarmEnv(name)
    env = SwarmEnv(name, iterations=3, min_population_size=4, action="extended")
    _, info = env.reset(seed=0)
    first, ended = info["best_fitness"], False
    while not ended:
        _, _, ended, _, info = env.step([4.0, 0.5, 0.6])
    assert info["best_fitness"] < first
    assert info["evaluations"] == 80 + 3 * 4

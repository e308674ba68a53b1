"""The code and commands in README.md and docs/guide.md work as they stand there."""

import os
import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[3]
LONGEST_README = 130  # lines


def blocks(page, language):
    """Return the code blocks of a page in a language, the empty text for those that name none."""
    text = (ROOT / page).read_text(encoding="utf-8")
    return re.findall(rf"^```{language}\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)


@pytest.mark.parametrize("page", ["README.md", "docs/guide.md"])
def test_python_code_runs_from_top_to_bottom(page, tmp_path, monkeypatch, capsys):
    pytest.importorskip("moviepy", reason="needs the extra `video`")
    pytest.importorskip("stable_baselines3", reason="needs the extra `study`")
    found = blocks(page, "python")
    assert len(found) >= 2
    monkeypatch.chdir(tmp_path)
    names = {}
    for code in found:
        exec(compile(code, page, "exec"), names)
    names["env"].close()
    if page == "README.md":
        best, evaluations, gap = map(float, capsys.readouterr().out.split())
        assert best > 300.0
        assert evaluations > 100_000
        assert 0.0 < gap < 0.5


def test_the_command_that_plans_a_path_writes_one(tmp_path):
    (line,) = [
        line for block in blocks("README.md", "") for line in block.splitlines() if "swarm_gym.plan" in line
    ]
    program, *arguments = shlex.split(line, comments=True)
    assert program == ".venv/bin/python"
    subprocess.run([sys.executable, *arguments], cwd=tmp_path, check=True, capture_output=True)
    assert (tmp_path / "path.csv").read_text().startswith("x,y\n")


@pytest.mark.slow
def test_the_commands_of_the_readme_work_one_after_the_other(tmp_path):
    """All but those of make, which the project's own checks run; a training takes minutes."""
    text = "\n".join(blocks("README.md", "")).replace("\\\n", " ")
    lines = [line for line in text.splitlines() if line.startswith(".venv/bin/python")]
    assert len(lines) >= 4
    for line in lines:
        _, *arguments = shlex.split(line, comments=True)
        environment = {**os.environ, "PYTHONPATH": str(ROOT)}
        done = subprocess.run(
            [sys.executable, *arguments],
            cwd=tmp_path,
            env=environment,
            capture_output=True,
            text=True,
            check=False,
        )
        assert done.returncode == 0, f"{line}\n{done.stderr[-2000:]}"
    assert (tmp_path / "results/mine/paper/report.html").is_file()


def test_the_readme_is_short():
    lines = (ROOT / "README.md").read_text(encoding="utf-8").splitlines()
    assert len(lines) <= LONGEST_README

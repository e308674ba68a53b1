"""The commands of docs/own-code.md, run as the page says."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from helpers.own_files import commands_of_the_page, write_own_files

ROOT = Path(__file__).parents[3]


@pytest.mark.slow
def test_the_files_and_commands_of_the_page_work_as_it_says(tmp_path):
    assert write_own_files(tmp_path) == [
        "my_swarms/rule.py",
        "my_swarms/swarm.py",
        "my_swarms/hall.py",
        "my_swarms/pay.py",
    ]
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "NUMBA_NUM_THREADS": "1"}
    commands = commands_of_the_page()
    assert len(commands) == 3
    for command in commands:
        words = [sys.executable, *command.split()[1:]]
        done = subprocess.run(
            words, cwd=tmp_path, env=environment, capture_output=True, text=True, check=False
        )
        assert done.returncode == 0, done.stderr[-2000:]
    page = (tmp_path / "results" / "paper" / "README.md").read_text()
    for name in (
        "my_swarms.rule:ByThirds",
        "my_swarms.swarm:HillClimber+my_swarms.rule:ByThirds",
        "SPSFA-TIP",
    ):
        assert f"| {name} |" in page
    report = (tmp_path / "results" / "paper" / "report.html").read_text()
    assert "my_swarms.rule:ByThirds" in report
    assert (tmp_path / "runs" / "optimizers" / "0" / "best.safetensors").exists()
    # Without --allow, the names in the database import nothing.
    report_words = [sys.executable, "-m", "experiments.report"]
    refused = subprocess.run(
        [*report_words, "results/paper.sqlite", "--scenarios", "my_swarms.hall:HALL"],
        cwd=tmp_path, env=environment, capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert refused.returncode != 0
    assert "never imports" in refused.stderr
    # The same name with other code is a new entry; the runs of the former one are kept aside.
    rule = tmp_path / "my_swarms" / "rule.py"
    rule.write_text(rule.read_text().replace("[60, 0.0]", "[61, 0.0]"))
    words = [sys.executable, *commands[0].split()[1:]]
    changed = subprocess.run(
        words, cwd=tmp_path, env=environment, capture_output=True, text=True, check=False
    )
    assert changed.returncode == 0, changed.stderr[-2000:]
    said = changed.stdout + changed.stderr
    assert "my_swarms.rule:ByThirds" in said
    assert "runs are kept as my_swarms.rule:ByThirds#" in said

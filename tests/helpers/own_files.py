"""The four files of docs/own-code.md, which is also their test."""

import re
import sys
from pathlib import Path

from swarm_gym import own_code

PAGE = Path(__file__).parents[2] / "docs" / "own-code.md"
FILES = re.compile(r"^`(my_swarms/\w+\.py)`:.*?```python\n(.*?)```", re.DOTALL | re.MULTILINE)
COMMANDS = re.compile(r"```\n(python -m .*?)```", re.DOTALL)


def write_own_files(folder):
    """Write the files into a folder and return their names."""
    found = FILES.findall(PAGE.read_text(encoding="utf-8"))
    for name, code in found:
        (folder / name).parent.mkdir(exist_ok=True)
        (folder / name).write_text(code, encoding="utf-8")
    return [name for name, _ in found]


def let_own_files_be_imported(folder, monkeypatch):
    """Write the files into a folder from which this test imports them; nothing is known of them before.

    The optimizer stays imported: a class of parameters can be registered only once.
    """
    write_own_files(folder)
    monkeypatch.syspath_prepend(str(folder))
    monkeypatch.setattr(own_code, "_given", set())
    monkeypatch.setattr(own_code, "_used", set())
    for name in {"my_swarms.rule", "my_swarms.hall", "my_swarms.pay"} & sys.modules.keys():
        monkeypatch.delitem(sys.modules, name)


def commands_of_the_page():
    """Return the commands, each as one line."""
    return [
        re.sub(r"\s*\\\n\s*", " ", block).strip()
        for block in COMMANDS.findall(PAGE.read_text(encoding="utf-8"))
    ]

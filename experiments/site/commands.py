"""The page of commands: what `--help` of each one prints."""

import io
import os
import pkgutil
import sys
import textwrap
from collections.abc import Iterator
from contextlib import contextmanager, redirect_stdout
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from types import ModuleType
from unittest.mock import patch

import agents
import experiments
from experiments.site.markdown import code, prose

# Width of the help in characters.
COLUMNS = 96
COMMANDS = {
    "Use": (
        "swarm_gym.plan", "swarm_gym.warm_up", "swarm_gym.scenarios.download",
        "swarm_gym.scenarios.terrain.convert_uav56", "swarm_gym.reference.waypoint_optimum",
    ),
    "Train": (
        "swarm_gym.training.command_line", "swarm_gym.tuning.command_line", "agents.train", "agents.tune",
        "agents.distil", "agents.import_sb3", "agents.export_onnx",
        "experiments.with_ray_tune",
    ),
    "Compare": (
        "swarm_gym.comparing.command_line", "experiments.evaluate", "experiments.report",
        "experiments.bbob", "experiments.planners", "experiments.readings", "experiments.entries",
    ),
    "Look": ("experiments.video",),
    "Measure": (
        "experiments.benchmark", "experiments.scaling", "experiments.sensitivity", "experiments.branching",
    ),
    "Publish": ("experiments.publish", "experiments.gallery", "experiments.plans"),
}  # fmt: skip
# Commands that take no options, and one that takes a file alone and prints no help.
WITHOUT_OPTIONS = ("swarm_gym.warm_up", "experiments.gallery")
WITHOUT_HELP = ("experiments.frame",)
# Packages whose modules at the top are commands, if they have a function `main`.
PACKAGES = (agents, experiments)


def commands_page() -> str:
    """Return the page with the help of all commands."""
    parts = [
        "# Commands\n\nEach command is a module: `python -m <name>`. This page shows what `--help` "
        "prints, by what a command is for."
    ]
    listed = {name for names in COMMANDS.values() for name in names}
    others = tuple(name for name in commands_at_the_top() if name not in (*listed, *WITHOUT_HELP))
    for purpose, names in {**COMMANDS, **({"Further commands": others} if others else {})}.items():
        parts.append(f"## {purpose}")
        parts += [f"### {code(name)}\n\n{_described(name)}" for name in names]
    return "\n\n".join(parts) + "\n"


def commands_at_the_top() -> list[str]:
    """Return the names of all commands of `agents` and `experiments`."""
    found = []
    for package in PACKAGES:
        for module in pkgutil.iter_modules(package.__path__, f"{package.__name__}."):
            source = Path(package.__path__[0]) / module.name.partition(".")[2]
            file = source / "__main__.py" if module.ispkg else source.with_suffix(".py")
            if file.is_file() and "\ndef main(" in file.read_text(encoding="utf-8"):
                found.append(module.name)
    return found


def help_of(name: str) -> str:
    """Return what `python -m <name> --help` prints.

    Raises:
        ValueError: if the command does not end with success.
    """
    printed = io.StringIO()
    try:
        with _command_line(name), redirect_stdout(printed):
            _module(name).main()
    except SystemExit as ended:
        if ended.code:
            raise ValueError(
                f"python -m {name} --help: expected success, got exit code {ended.code}"
            ) from ended
    return "\n".join(_wrapped(line.rstrip()) for line in printed.getvalue().strip().splitlines())


def _wrapped(line: str) -> str:
    """Return a line, broken where it is longer than the help; further lines are indented as the first one."""
    indent = " " * (len(line) - len(line.lstrip()))
    if len(line) <= COLUMNS:
        return line
    return textwrap.fill(line.strip(), COLUMNS, initial_indent=indent, subsequent_indent=indent)


@contextmanager
def _command_line(name: str) -> Iterator[None]:
    """Set the arguments, and the width that help is broken to."""
    with (
        patch.object(sys, "argv", [f"python -m {name}", "--help"]),
        patch.dict(os.environ, {"COLUMNS": str(COLUMNS), "NO_COLOR": "1", "PYTHON_COLORS": "0"}),
    ):
        yield


def _described(name: str) -> str:
    """Return the help of a command, or the docstring of one that takes no options."""
    if name in WITHOUT_OPTIONS:
        return f"{prose(_module(name))}\n\nIt takes no options."
    return f"```text\n{help_of(name)}\n```"


def _module(name: str) -> ModuleType:
    """Return the module that `python -m <name>` runs."""
    main = f"{name}.__main__"
    is_package = (spec := find_spec(name)) is not None and spec.submodule_search_locations is not None
    return import_module(main if is_package else name)

"""Snapshot of the public names of the project, to which scripts, stored results and papers of users refer.

`python tests/public_names.py` prints how the names differ from those of `public_names.txt`, and exits with
status 1 if they do. With `--write` it writes the file anew: whoever adds, renames or removes a name sees it
in the diff.
"""

import argparse
import ast
import json
import re
import sqlite3
import struct
import sys
import tempfile
from collections.abc import Iterable, Iterator
from contextlib import closing
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path

import gymnasium
import numpy as np

ROOT = Path(__file__).parents[1]
FILE = ROOT / "tests/public_names.txt"
PACKAGES = ("swarm_gym", "agents", "experiments")
# Adapted algorithms are names of own code, so no registry has them.
LIBRARIES = {"swarm_gym.adapters.pymoo": "pymoo", "swarm_gym.adapters.niapy": "niapy"}
_HEAD = """\
# Public names of the project. `python tests/public_names.py --write` writes this file.
# A name that goes breaks somebody's work: remove one on purpose only.
"""

if __name__ == "__main__":
    sys.path.insert(0, str(ROOT))


def current() -> dict[str, list[str]]:
    """Return the names that there are now, sorted, by section.

    A section of a library that is not installed is missing.
    """
    found = dict(_sections())
    return {section: sorted(set(found[section])) for section in sorted(found)}


def stored() -> dict[str, list[str]]:
    """Return the names in the file, by section."""
    sections: dict[str, list[str]] = {}
    for line in FILE.read_text(encoding="utf-8").splitlines():
        if line.startswith("["):
            names = sections.setdefault(line[1:-1], [])
        elif line and not line.startswith("#"):
            names.append(line)
    return sections


def differences(old: dict[str, list[str]], new: dict[str, list[str]]) -> list[str]:
    """Return a line for each name that went (`-`) or came (`+`), with its section."""
    pairs = {
        sign: {(section, name) for section, names in sections.items() for name in names or [""]}
        for sign, sections in (("-", old), ("+", new))
    }
    gone, added = pairs["-"] - pairs["+"], pairs["+"] - pairs["-"]
    changes = sorted([(*pair, "-") for pair in gone] + [(*pair, "+") for pair in added])
    return [f"{sign} {section}: {name}".rstrip(": ") for section, name, sign in changes]


def without_missing_libraries(sections: dict[str, list[str]]) -> dict[str, list[str]]:
    """Return the sections that can be found with the libraries that are installed."""
    missing = [module for module, library in LIBRARIES.items() if find_spec(library) is None]
    return {
        section: names
        for section, names in sections.items()
        if not any(section.startswith(f"options of {module}:") for module in missing)
        and section not in [f"algorithms of {module}" for module in missing]
    }


def _sections() -> Iterator[tuple[str, Iterable[str]]]:
    yield from _registries()
    yield from _environments()
    yield from _controllers()
    yield from _files()
    yield from _modules()
    yield from _commands()


def _registries() -> Iterator[tuple[str, Iterable[str]]]:
    from experiments.catalogue import COLLECTIONS, SUITES, TABLES, figures
    from experiments.publish import DOCUMENTS
    from swarm_gym.action import ACTIONS
    from swarm_gym.history import HISTORY
    from swarm_gym.observation import OBSERVATIONS
    from swarm_gym.optimizers import OPTIMIZERS
    from swarm_gym.reset_options import RESET_OPTIONS
    from swarm_gym.reward import REWARDS
    from swarm_gym.scenarios import FAMILIES, SCENARIOS
    from swarm_gym.training.learners import LEARNERS
    from swarm_gym.training.presets import preset_names

    yield from {
        "action layouts": ACTIONS,
        "collections": COLLECTIONS,
        "documents": DOCUMENTS,
        "figures": figures(),
        "history": HISTORY,
        "learning algorithms": LEARNERS,
        "observation layouts": OBSERVATIONS,
        "optimizers": OPTIMIZERS,
        "presets": preset_names(),
        "reset options": RESET_OPTIONS,
        "rewards": REWARDS,
        "scenarios": SCENARIOS,
        "scenario families": FAMILIES,
        "suites": SUITES,
        "tables": TABLES,
    }.items()


def _environments() -> Iterator[tuple[str, Iterable[str]]]:
    from swarm_gym.env import SwarmEnv
    from swarm_gym.registration import environment_id

    names = [name for name in gymnasium.registry if name.startswith("swarm_gym/")]
    yield "environments", names
    options = {name: _valid_options(gymnasium.make, name) for name in names}
    common = set.intersection(*options.values())
    yield "options of all environments", common
    for name, own in options.items():
        if own != common:
            yield f"options of {name}", own - common
    for module, library in LIBRARIES.items():
        if find_spec(library) is None:
            continue
        classes = [
            cls
            for cls, value in vars(import_module(module)).items()
            if getattr(value, "name", None) == f"{module}:{cls}"
        ]
        yield f"algorithms of {module}", classes
        for cls in classes:
            yield f"options of {module}:{cls}", _valid_options(SwarmEnv, f"{module}:{cls}") - common
    env = gymnasium.make(
        environment_id("firefly"),
        iterations=1,
        scenario="dynamic:case3-drive@40,every=5,distance=80",
        source="smooth",
        amplitude=0.1,
        initial_population_size=200,
        final_repair=True,
    )
    env.reset(seed=0)  # with a feasible member
    *_, info = env.step(np.array([200, 0.5]))
    yield "info", info


def _valid_options(make, name: str) -> set[str]:
    """Return the options that an environment takes, as the refusal of another one lists them."""
    from swarm_gym.errors import UnknownNameError

    try:
        make(name, no_such_option=1)
    except UnknownNameError as refused:
        return set(refused.valid)
    raise AssertionError(f"{name} takes any option")


def _controllers() -> Iterator[tuple[str, Iterable[str]]]:
    from swarm_gym.controllers import CONTROLLERS, make_controller
    from swarm_gym.errors import SettingError

    yield "controller families", CONTROLLERS
    for family in CONTROLLERS:
        try:
            make_controller(f"{family}:no_such_parameter=1")
        except SettingError as refused:
            if names := re.findall(r"(\w+) (?:integer )?in \[", str(refused)):
                yield f"parameters of {family}", names
        except ValueError:
            pass  # a family that has files


def _files() -> Iterator[tuple[str, Iterable[str]]]:
    from experiments.runs.database import Results
    from swarm_gym.controllers.distilled import DISTILLED
    from swarm_gym.controllers.learned.policy_file import POLICIES, packaged_policies
    from swarm_gym.controllers.open_loop import OPEN_LOOPS
    from swarm_gym.controllers.tuned import TUNED

    for packaged in (POLICIES, OPEN_LOOPS, TUNED, DISTILLED):
        yield f"packaged {packaged.kind}", _by_recipe(packaged.names())
    yield (
        "entries of a policy's manifest",
        {entry for name in packaged_policies() for entry in _manifest(POLICIES.find(name))},
    )
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "results.db"
        Results(path).close()
        with closing(sqlite3.connect(path)) as connection:
            tables = [
                row[0] for row in connection.execute("SELECT name FROM sqlite_master WHERE type='table'")
            ]
            yield (
                "columns of the database",
                [
                    f"{table}.{row[1]}"
                    for table in tables
                    for row in connection.execute(f"PRAGMA table_info({table})")
                ],
            )


def _by_recipe(names: Iterable[str]) -> Iterator[str]:
    """Yield the names; those that differ in their training seed only are one, with all seeds behind it."""
    seeds: dict[str, list[str]] = {}
    for name in names:
        seed = re.search(r"(?<=/)\d+(?=@|$)", name)
        recipe = name if seed is None else f"{name[: seed.start()]}*{name[seed.end() :]}"
        seeds.setdefault(recipe, []).extend([seed[0]] if seed else [])
    for recipe, found in seeds.items():
        yield " ".join([recipe, *sorted(found, key=int)])


def _manifest(path: Path) -> Iterable[str]:
    content = path.read_bytes()
    (length,) = struct.unpack("<Q", content[:8])
    header = json.loads(content[8 : 8 + length])
    return json.loads(header["__metadata__"]["manifest"])


def _modules() -> Iterator[tuple[str, Iterable[str]]]:
    """Yield the public names of the modules that the reference of the site shows."""
    from experiments.site.reference import PAGES, public_names

    for page in PAGES.values():
        for module in page.modules:
            yield f"module {module}", public_names(import_module(module))
        for module, names in page.parts.items():
            yield f"module {module}", names


def _commands() -> Iterator[tuple[str, Iterable[str]]]:
    from swarm_gym.__main__ import COMMANDS

    yield "commands of swarm-gym", COMMANDS
    for package in PACKAGES:
        for file in sorted((ROOT / package).rglob("*.py")):
            text = file.read_text(encoding="utf-8")
            if "\ndef main(" in text and '__name__ == "__main__"' in text:
                module = ".".join(file.relative_to(ROOT).with_suffix("").parts).removesuffix(".__main__")
                yield f"options of python -m {module}", _options_of(file)


def _options_of(file: Path) -> Iterator[str]:
    """Yield the options of a command from its source, since to import all commands takes seconds.

    They are the fields of the dataclasses that the command gives to `tyro.cli`, or the arguments that it adds
    to a parser.
    """
    tree = ast.parse(file.read_text(encoding="utf-8"))
    for call in (node for node in ast.walk(tree) if isinstance(node, ast.Call)):
        if ast.unparse(call.func) == "tyro.cli":
            name = ast.unparse(call.args[0])
            if name[0].isupper():  # a class, and not one that is made while the command runs
                yield from _fields(tree, name)
        elif ast.unparse(call.func) == "tyro.extras.subcommand_cli_from_dict":
            for key, cls in zip(call.args[0].keys, call.args[0].values, strict=True):
                yield from (f"{key.value} {option}" for option in [*_fields(tree, ast.unparse(cls))])
        elif ast.unparse(call.func).endswith(".add_argument"):
            yield from [argument.value for argument in call.args]


def _fields(tree: ast.Module, name: str) -> Iterator[str]:
    """Yield the options of a dataclass that a module defines or imports, those of its parts included."""
    from swarm_gym.training.algorithms import EVERY_OPTION

    definition = next(
        (node for node in tree.body if isinstance(node, ast.ClassDef) and node.name == name), None
    )
    if definition is None:
        (module,) = [
            node.module
            for node in ast.walk(tree)
            if isinstance(node, ast.ImportFrom) and name in [alias.name for alias in node.names]
        ]
        yield from _fields(ast.parse(_file_of(module).read_text(encoding="utf-8")), name)
        return
    aliases = {
        ast.unparse(node.targets[0]): ast.unparse(node.value)
        for node in tree.body
        if isinstance(node, ast.Assign)
    }
    for field in definition.body:
        if isinstance(field, ast.AnnAssign):
            kind = ast.unparse(field.annotation)
            kind = aliases.get(kind, kind)
            if "AvoidSubcommands[AnyAlgorithm]" in kind:
                yield "--algorithm"
                yield from (f"--{option.replace('_', '-')}" for option in EVERY_OPTION)
            elif inner := re.fullmatch(r"tyro\.conf\.OmitArgPrefixes\[(\w+)\]", kind):
                yield from _fields(tree, inner[1])
            else:
                option = field.target.id.replace("_", "-")
                yield option if "Positional" in kind else f"--{option}"


def _file_of(module: str) -> Path:
    place = ROOT / module.replace(".", "/")
    return next(file for file in (place.with_suffix(".py"), place / "__init__.py") if file.is_file())


def main() -> int:
    """Compare the names with those of the file, or write the file; return the status of the command."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--write", action="store_true", help="write the file anew")
    arguments = parser.parse_args()
    new = current()
    if arguments.write:
        if FILE.is_file():
            old = stored()
            new |= {section: old[section] for section in old.keys() - without_missing_libraries(old).keys()}
        parts = ["\n".join([f"[{section}]", *names, ""]) for section, names in sorted(new.items())]
        FILE.write_text("\n".join([_HEAD, *parts]), encoding="utf-8")
        return 0
    changes = differences(without_missing_libraries(stored()), new)
    print("\n".join(changes))
    return 1 if changes else 0


if __name__ == "__main__":
    sys.exit(main())

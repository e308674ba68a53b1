"""Code of pages trains on seeds for training, and its own code stands in one folder that nothing shadows."""

import ast
import re
from importlib.metadata import packages_distributions
from pathlib import Path

import pytest

from swarm_gym.runs.seeds import TRAINING_START

ROOT = Path(__file__).parents[3]
PAGES = ["README.md", *(str(path.relative_to(ROOT)) for path in sorted(ROOT.glob("docs/**/*.md")))]
FENCE = re.compile(r"^```(?:python|\{code-cell\} python3)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
FOLDER = "my_swarms"
# What code that trains or tunes calls.
TRAINS = re.compile(r"\.learn\(|\.backward\(|\bPPO\(|PPOConfig\(|create_study\(")
# Calls that give a seed to swarms, by the last part of their names.
SEEDED = ("make_vec", "reset", "debugging")


def seeds_of(code):
    """Return the seeds that code gives to swarms; None for one that it leaves to chance."""
    # Lines of a notebook that are no Python, and code that is cut off in the middle of a page.
    tree = ast.parse(re.sub(r"^[!%].*$", "", code, flags=re.MULTILINE))
    constants = {}
    for node in ast.walk(tree):
        if isinstance(node, ast.Assign):
            (names,), values = node.targets, node.value
            both = isinstance(names, ast.Tuple) and isinstance(values, ast.Tuple)
            pairs = zip(names.elts, values.elts, strict=True) if both else [(names, values)]
            constants |= {
                name.id: value.value
                for name, value in pairs
                if isinstance(name, ast.Name) and isinstance(value, ast.Constant)
            }
    found = []
    for node in ast.walk(tree):
        called = node.func if isinstance(node, ast.Call) else None
        name = getattr(called, "attr", getattr(called, "id", ""))
        if name not in SEEDED:
            continue
        given = {keyword.arg: keyword.value for keyword in node.keywords}.get("seed")
        if isinstance(given, ast.Name):
            found.append(constants[given.id])
        elif isinstance(given, ast.Constant):
            found.append(given.value)
        elif name == "make_vec" and isinstance(called, ast.Name):  # that of stable-baselines3 resets itself
            found.append(None)
    return found


def trainings_of(page):
    """Return the pieces of code of a page that train."""
    return [code for code in FENCE.findall((ROOT / page).read_text(encoding="utf-8")) if TRAINS.search(code)]


def test_pages_train_on_seeds_for_training_only():
    pieces = [(page, code) for page in PAGES for code in trainings_of(page)]
    assert len(pieces) >= 7
    wrong = [
        (page, seed)
        for page, code in pieces
        for seed in seeds_of(code)
        if seed is None or seed < TRAINING_START
    ]
    assert wrong == []


@pytest.mark.parametrize(
    ("code", "seeds"),
    [
        ("SEED, FIRST = 0, 7\nenvs.reset(seed=FIRST)", [7]),
        ("swarms = make_vec('firefly', 16)", [None]),
        ("envs = gymnasium.make_vec('a')\nenvs.reset(seed=3)\ncontroller.reset(4)", [3]),
        ("%pip install a\nmake_vec('firefly', seed=1_000_000)", [1_000_000]),
    ],
)
def test_seeds_are_found_in_code(code, seeds):
    assert seeds_of(code) == seeds


def test_no_two_pages_write_the_same_file_and_all_are_in_one_folder():
    written = []
    for page in PAGES:
        text = (ROOT / page).read_text(encoding="utf-8")
        files = re.findall(r"^%%writefile (\w+)/(\w+)\.py", text, re.MULTILINE)
        written += [(*file, page) for file in [*files, *re.findall(rf"`({FOLDER})/(\w+)\.py`:", text)]]
    assert len(written) >= 9
    assert {folder for folder, *_ in written} == {FOLDER}
    names = [name for _, name, _ in written]
    assert sorted(set(names)) == sorted(names), written


def test_the_folder_of_own_code_has_the_name_of_no_package():
    assert FOLDER not in packages_distributions()
    assert not (ROOT / f"{FOLDER}.py").exists()

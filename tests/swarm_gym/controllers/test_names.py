"""Names of controllers: taken apart in one place, and put together as they were."""

import ast
import re
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from agents import CONTROLLERS, make_controller
from experiments.catalogue import SUITES
from helpers.mutations import fuzzed
from swarm_gym.comparing.entrants import entrant
from swarm_gym.controllers.distilled import packaged_rules
from swarm_gym.controllers.learned.policy_file import packaged_policies
from swarm_gym.controllers.names import ALL_SEEDS, BLINDED, FITTED, ControllerName
from swarm_gym.controllers.open_loop import packaged_open_loops
from swarm_gym.controllers.tuned import packaged_tuned
from swarm_gym.errors import UnknownNameError
from swarm_gym.optimizers import OPTIMIZERS

PACKAGED = {
    "distilled": packaged_rules(),
    "learned": packaged_policies(),
    "open-loop": packaged_open_loops(),
    "tuned": packaged_tuned(),
}
NAMES = {
    *(name for suite in SUITES.values() for name in suite.controllers),
    *(f"{family}:{name}" for family, names in PACKAGED.items() for name in names),
    *CONTROLLERS,
}
SOURCES = Path(__file__).parents[3]
# Modules that take apart names of something else than controllers.
OTHER_NAMES = {
    "swarm_gym/scenarios": "scenarios",
    "swarm_gym/compiler": "files of the compiler",
    "swarm_gym/observation.py": "observation layouts joined by +",
    "swarm_gym/own_code.py": "modules and attributes of own code",
    "swarm_gym/registration.py": "modules and attributes of own code",
    "swarm_gym/training/own_names.py": "observation layouts joined by +",
    "swarm_gym/controllers/learned/manifest.py": "observation layouts joined by +",
    "agents/backends/ray_backend.py": "addresses of clusters",
    "experiments/runs/groups.py": "scenarios",
    "experiments/documents/figures.py": "file names of figures",
    "experiments/tables/reshape.py": "columns of tables",
    "experiments/studies/moa/tables.py": "scenarios",
    "experiments/studies/brand_yu/tables.py": "scenarios",
    "experiments/studies/iafsa/published.py": "scenarios",
    "experiments/studies/iafsa/routes.py": "scenarios",
    "experiments/studies/terrain/best_known.py": "scenarios",
    "experiments/studies/terrain/tables_of_costs.py": "scenarios",
    "experiments/speed": "benchmarks and processors",
}
PARSERS = {"partition", "rpartition", "split", "rsplit", "removeprefix", "removesuffix", "startswith"}


def group_key_by_hand(controller):
    """Return the key of a group as it was computed before names had a type."""
    recipe, _, rest = controller.rpartition("/")
    training_seed, at, price = rest.partition("@")
    return f"{recipe}/*{at}{price}" if recipe and training_seed.isdigit() else controller


def test_names_are_put_together_as_they_were():
    assert len(NAMES) > 1000
    for name in sorted(NAMES):
        parts = ControllerName.parse(name)
        assert str(parts) == name
        assert parts.group_key == group_key_by_hand(name)
        assert ControllerName.parse(parts.group_key).group_key == parts.group_key
        assert parts.family in (*CONTROLLERS, BLINDED), name
        assert (parts.parameters is None) or (parts.recipe is None), name


@given(name=st.text() | st.text(alphabet="ab/@:*+(19)="))
@fuzzed
def test_any_text_is_put_together_as_it_was(name):
    assert str(ControllerName.parse(name)) == name
    assert ControllerName.parse(name).argument == name.partition(":")[2]


recipes = st.from_regex(r"[a-z./-]*[a-z.]", fullmatch=True)


@given(
    family=st.sampled_from(FITTED),
    recipe=recipes,
    seed=st.none() | st.integers(0, 10**6) | st.just(ALL_SEEDS),
    price=st.none() | st.floats(0, 100).map("{:g}".format),
    optimizer=st.none() | st.sampled_from(sorted(OPTIMIZERS)),
    iterations=st.integers(1, 10**6),
)
@fuzzed
def test_parts_of_fitted_controllers_are_found_again(family, recipe, seed, price, optimizer, iterations):
    length = None if optimizer is None else iterations
    name = ControllerName(family, recipe, seed, price, None, optimizer, length)
    assert ControllerName.parse(str(name)) == name
    assert name.group_key == group_key_by_hand(str(name))
    assert ControllerName.parse(str(name.controller)) == ControllerName(family, recipe, seed, price)


@given(
    family=st.sampled_from(sorted(set(CONTROLLERS) - set(FITTED))),
    parameters=st.none() | st.from_regex(r"[a-z_]+=[0-9.e+-]+(,[a-z_]+=[0-9.e+-]+)*", fullmatch=True),
    optimizer=st.none() | st.sampled_from(sorted(OPTIMIZERS)),
)
@fuzzed
def test_parts_of_controllers_with_parameters_are_found_again(family, parameters, optimizer):
    name = ControllerName(family, parameters=parameters, optimizer=optimizer)
    assert ControllerName.parse(str(name)) == name
    assert name.group_key == str(name)
    assert name.argument == (parameters or "")


@pytest.mark.parametrize(
    ("name", "recipe", "seed", "price"),
    [
        ("learned:three-cases/0@0.3", "three-cases", 0, "0.3"),
        ("learned:three-cases/*@0.3", "three-cases", ALL_SEEDS, "0.3"),
        ("learned:a/12", "a", 12, None),
        ("learned:a/007", "a/007", None, None),
        ("open-loop:three-cases@0.5", "three-cases", None, "0.5"),
        ("open-loop:three-cases-extended-13-knots@0.02", "three-cases-extended-13-knots", None, "0.02"),
        ("tuned:/home/me@work/mine.json", "/home/me@work/mine.json", None, None),
        ("learned:/home/me@work/mine@2", "/home/me@work/mine", None, "2"),
        ("learned:x/0@cheap", "x", 0, "cheap"),
    ],
)
def test_what_follows_the_last_at_is_the_price(name, recipe, seed, price):
    parts = ControllerName.parse(name)
    assert (parts.recipe, parts.seed, parts.price) == (recipe, seed, price)
    assert str(parts) == name


def test_a_wrong_name_says_which_part_is_wrong():
    with pytest.raises(ValueError, match=r"'learned:x/0@1'|neither a packaged one"):
        make_controller("learned:x/0@1")
    with pytest.raises(ValueError, match="'cheap' is not a price"):
        make_controller("learned:three-cases/0@cheap")
    with pytest.raises(ValueError, match=r"'multivariate' may only be named in a suite.*'fixed:65'"):
        make_controller("multivariate+fixed:65")
    with pytest.raises(UnknownNameError, match=r"'bees\+fixed:65'.*'bees'; valid: "):
        entrant("bees+fixed:65", "firefly")
    with pytest.raises(UnknownNameError, match=r"unknown controller 'fxed'.*valid: .*fixed"):
        make_controller("fxed:60")


def _separators(node):
    """Yield the texts by which a call takes a text apart."""
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute) and node.func.attr in PARSERS:
        for argument in node.args:
            if isinstance(argument, ast.Constant) and isinstance(argument.value, str):
                yield argument.value
    if isinstance(node, ast.Call) and ast.unparse(node.func) in ("re.match", "re.fullmatch", "re.compile"):
        yield from (a.value for a in node.args if isinstance(a, ast.Constant))


def test_names_are_taken_apart_in_one_module():
    families = {f"{family}:" for family in CONTROLLERS}
    found = []
    for package in ("swarm_gym", "agents", "experiments"):
        for path in sorted((SOURCES / package).rglob("*.py")):
            place = path.relative_to(SOURCES).as_posix()
            if place == "swarm_gym/controllers/names.py" or place.startswith(tuple(OTHER_NAMES)):
                continue
            for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
                for text in _separators(node):
                    if text in {":", "@", "/", "/*", "+"} | families or re.search(r"\\\+|:\(|@", text):
                        found.append(f"{place}:{node.lineno}: {text!r}")
    assert not found

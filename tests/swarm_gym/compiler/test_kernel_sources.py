"""The cache of kernels knows all sources that they are compiled from."""

import ast
from functools import cache
from pathlib import Path

import swarm_gym
from helpers.loops import looped
from swarm_gym.compiler.cache import KERNEL_SOURCES

PACKAGE = Path(swarm_gym.__file__).parent
DECORATORS = {"entry", "kernel", "intrinsic", "njit"}
CALLS = {"kernel_by_class", "overload"}


def module_name(path):
    return ".".join(("swarm_gym", *path.relative_to(PACKAGE).with_suffix("").parts))


def name_of(expression):
    """The name of what is called or used as a decorator."""
    target = expression.func if isinstance(expression, ast.Call) else expression
    return target.attr if isinstance(target, ast.Attribute) else getattr(target, "id", None)


def is_compiled(node):
    return isinstance(node, ast.FunctionDef) and any(name_of(d) in DECORATORS for d in node.decorator_list)


def has_kernels(tree):
    calls = {name_of(node) for node in ast.walk(tree) if isinstance(node, ast.Call)}
    return bool(calls & CALLS) or any(map(is_compiled, ast.walk(tree)))


def is_kernel_source(module):
    """Return whether a module, by its dotted name, lies in one of the places."""
    parts = [place.removesuffix(".py").replace("/", ".") for place in KERNEL_SOURCES]
    return any(f"{module}.".startswith(f"swarm_gym.{part}.") for part in parts)


def imported_names(tree):
    """Name -> the modules that it may come from."""
    return {
        alias.asname or alias.name: {node.module, f"{node.module}.{alias.name}"}
        for node in ast.walk(tree)
        if isinstance(node, ast.ImportFrom)
        for alias in node.names
    }


def names_in(node):
    return {inner.id for inner in ast.walk(node) if isinstance(inner, ast.Name)}


def names_that_kernels_use(tree):
    """All names in compiled functions, and those in the module's definitions of these names."""
    definitions = {}
    for node in tree.body:
        if isinstance(node, ast.Assign | ast.AnnAssign) and node.value is not None:
            for target in getattr(node, "targets", None) or [node.target]:
                for name in names_in(target):
                    definitions.setdefault(name, set()).update(names_in(node.value))
    used, found = set(), set()
    for node in ast.walk(tree):
        if is_compiled(node):
            found |= set().union(*(names_in(statement) for statement in node.body))
    while found - used:
        used |= found
        found = set().union(*(definitions.get(name, set()) for name in used))
    return used


def strangers(tree):
    """Names that kernels of a module use, and that come from the package, but not from kernel sources."""
    origins = imported_names(tree)
    return {
        name
        for name in names_that_kernels_use(tree) & set(origins)
        if any(module.startswith("swarm_gym") for module in origins[name])
        and not any(is_kernel_source(module) for module in origins[name])
    }


@cache
def modules():
    """Syntax trees by name of module; kernels for GPUs are compiled by numba-cuda, and not cached."""
    return {
        module_name(path): ast.parse(path.read_text(encoding="utf-8"))
        for path in sorted(PACKAGE.rglob("*.py"))
        if path.relative_to(PACKAGE).parts[0] != "gpu"
    }


@cache
def with_kernels():
    """Names of the modules that have kernels."""
    return [name for name, tree in modules().items() if has_kernels(tree)]


def test_every_place_exists_and_has_kernels():
    for place in KERNEL_SOURCES:
        assert (PACKAGE / place).exists()
        start = f"swarm_gym.{place.removesuffix('.py').replace('/', '.')}."
        assert any(f"{name}.".startswith(start) for name in with_kernels())


@looped("module", with_kernels)
def test_modules_with_kernels_are_kernel_sources(module):
    assert is_kernel_source(module)


@looped("module", with_kernels)
def test_kernels_use_nothing_from_outside_of_the_kernel_sources(module):
    assert strangers(modules()[module]) == set()


OUTSIDE = """
from swarm_gym.settings import LIMIT
from swarm_gym.problem.tables import evaluate
from swarm_gym.errors import SettingError

TWICE = 2 * LIMIT

def plain():
    raise SettingError

@kernel(inline="late")
def bounded(table, path):
    return min(evaluate(table, path), TWICE)
"""


def test_the_check_finds_constants_that_are_computed_from_others():
    assert strangers(ast.parse(OUTSIDE)) == {"LIMIT"}

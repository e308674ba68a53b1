"""Pages of the reference: which modules are public, and directives of autodoc for their names."""

import ast
import inspect
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from importlib import import_module
from pathlib import Path
from types import GenericAlias, ModuleType
from typing import Any

# Longest value of a constant that is shown.
LONGEST_VALUE = 90


@dataclass(frozen=True)
class ReferencePage:
    """A page of the reference.

    Attributes:
        title: heading of the page.
        purpose: sentence that says what the page is for.
        modules: names of the modules; all their public names are shown.
        parts: names of the modules of which only some names are shown, with these names.
    """

    title: str
    purpose: str
    modules: tuple[str, ...] = ()
    parts: Mapping[str, tuple[str, ...]] = field(default_factory=dict)


PAGES = {
    "environments": ReferencePage(
        "Environments",
        "Environments of one swarm and of many, and their options.",
        (
            "swarm_gym", "swarm_gym.env", "swarm_gym.vector_env", "swarm_gym.settings",
            "swarm_gym.worlds", "swarm_gym.measures", "swarm_gym.reset_options",
            "swarm_gym.registration", "swarm_gym.simulation",
            "swarm_gym.rendering",
        ),
    ),
    "layouts": ReferencePage(
        "Actions, observations and rewards",
        "Numbers that a controller decides, sees and is paid.",
        (
            "swarm_gym.action", "swarm_gym.observation", "swarm_gym.features", "swarm_gym.reward",
            "swarm_gym.sources",
        ),
    ),
    "controllers": ReferencePage(
        "Controllers",
        "Everything that decides on population size and repair degree.",
        (
            "swarm_gym.controllers", "swarm_gym.controllers.names", "swarm_gym.controllers.fixed",
            "swarm_gym.controllers.schedules", "swarm_gym.controllers.size_rules",
            "swarm_gym.controllers.immigrants", "swarm_gym.controllers.open_loop",
            "swarm_gym.controllers.reacting_loop", "swarm_gym.controllers.tuned",
            "swarm_gym.controllers.distilled", "swarm_gym.controllers.learned.policy_file",
        ),
    ),
    "scenarios": ReferencePage(
        "Scenarios",
        "Maps, tasks, test functions and events, and how their names are read.",
        ("swarm_gym.scenarios", "swarm_gym.scenarios.family", "swarm_gym.scenarios.download"),
    ),
    "optimizers": ReferencePage(
        "Optimizers",
        "The interface of an optimizer, and the kernels that one of your own calls.",
        (
            "swarm_gym.optimizers", "swarm_gym.optimizers.optimizer", "swarm_gym.optimizers.parameter",
        ),
        {
            # Before kernels that its decorators make, or links from its source lead astray.
            "swarm_gym.compiler.jit": ("kernel", "entry"),
            "swarm_gym.optimizers.loop": (
                "Kernels", "draw_population", "resize_population", "adopt_population",
                "re_evaluate_population", "summarise_population",
            ),
            "swarm_gym.population": (
                "Swarms", "Workspace", "evaluate_member", "evaluate_path", "is_spent", "span",
            ),
            "swarm_gym.problem.tables": ("repair",),
            "swarm_gym.compiler.random_stream": ("fill_uniform",),
        },
    ),
    "planning": ReferencePage(
        "Planning",
        "A free path on any map, the repair of paths, and planners to compare with.",
        (
            "swarm_gym.planning", "swarm_gym.planning.flights", "swarm_gym.final_repair",
            "swarm_gym.reference",
        ),
    ),
    "own-code": ReferencePage(
        "Own code",
        "Names of your own code, the contracts that it keeps, and bridges to other libraries.",
        (
            "swarm_gym.own_code", "swarm_gym.testing", "swarm_gym.sb3", "swarm_gym.learner_options",
            "swarm_gym.adapters.library", "swarm_gym.adapters.swarm_view",
        ),
    ),
    "errors": ReferencePage(
        "Errors", "All errors that the package raises on purpose.", ("swarm_gym.errors",)
    ),
    "agents": ReferencePage(
        "Training",
        "How controllers come about: training, presets, rollouts and backends.",
        (
            # Algorithms before what their names are imported into, or links from their source lead astray.
            "agents", "swarm_gym.training.algorithms", "swarm_gym.training.config",
            "swarm_gym.training.presets",
            "swarm_gym.training.learners",
            "swarm_gym.training.learners.learner", "swarm_gym.wrappers", "swarm_gym.rollout",
            "swarm_gym.tuning.config",
            "agents.backends", "agents.backends.options",
        ),
    ),
    "comparing": ReferencePage(
        "Comparing",
        "Controllers on the same scenarios and seeds: gaps, evaluations, intervals and a table.",
        ("swarm_gym.comparing", "swarm_gym.comparing.entrants"),
    ),
    "experiments": ReferencePage(
        "Experiments",
        "Suites, their results, and the statistics and tables that are made of these.",
        (
            "experiments.catalogue", "experiments.runs.experiment", "experiments.runs.suite",
            "experiments.runs.database", "experiments.runs.outcomes", "experiments.statistics",
            "experiments.tables.table", "experiments.tables.cell",
        ),
    ),
}  # fmt: skip


def reference_pages() -> dict[str, str]:
    """Return all pages of the reference as reStructuredText, by the name of the page."""
    seen: dict[int, str] = {}
    return {name: "\n".join(_page(page, seen)) for name, page in PAGES.items()}


def public_names(module: ModuleType) -> tuple[str, ...]:
    """Return the public names of a module: those of `__all__`, or else all that its source defines."""
    if hasattr(module, "__all__"):
        return tuple(module.__all__)
    defined = dict.fromkeys(name for node in _source(module).body for name in _defined(node))
    return tuple(
        name
        for name in defined
        # An abbreviation of a type is not public.
        if not name.startswith("_") and not isinstance(getattr(module, name), GenericAlias)
    )


def _page(page: ReferencePage, seen: dict[int, str]) -> Iterator[str]:
    """Yield the lines of a page; `seen` maps the identity of each object shown so far to its full name."""
    yield from (page.title, "=" * len(page.title), "", page.purpose, "")
    chosen = {name: public_names(import_module(name)) for name in page.modules} | dict(page.parts)
    for name, names in chosen.items():
        module = import_module(name)
        yield from (name, "-" * len(name), "", f".. automodule:: {name}", "")
        elsewhere = []
        for public in names:
            found = getattr(module, public)
            known = seen.get(id(found))
            if known is not None:
                elsewhere.append((public, known))
                continue
            if isinstance(found, type | Mapping) or callable(found):  # equal numbers may be one object
                seen[id(found)] = f"{name}.{public}"
            yield from _directive(module, public)
        if elsewhere:
            links = ", ".join(f":py:obj:`{public} <{known}>`" for public, known in elsewhere)
            yield from (f"It also has these names: {links}.", "")


def _directive(module: ModuleType, name: str) -> Iterator[str]:
    """Yield the directive that shows one name."""
    found, full = getattr(module, name), f"{module.__name__}.{name}"
    if isinstance(found, type):
        kind = "autoexception" if issubclass(found, BaseException) else "autoclass"
        yield from (f".. {kind}:: {full}", "   :members:", "")
    elif inspect.isroutine(found) or hasattr(found, "py_func"):
        yield from (f".. autofunction:: {full}", "")
    else:
        yield from _constant(module, name, found)


def _constant(module: ModuleType, name: str, value: Any) -> Iterator[str]:
    """Yield the directive of a constant or registry, with the comment above it in the source."""
    yield f".. py:data:: {module.__name__}.{name}"
    if len(repr(value)) <= LONGEST_VALUE:
        yield f"   :value: {value!r}"
    comment = _comment_above(module, name)
    yield from ("", f"   {comment}" if comment else "", "")
    if isinstance(value, Mapping) and all(isinstance(key, str) for key in value):
        yield from (f"   Names: {', '.join(f'``{key}``' for key in value)}.", "")


def _source(module: ModuleType) -> ast.Module:
    return ast.parse(inspect.getsource(module))


def _defined(node: ast.stmt) -> list[str]:
    """Return the names that a statement at the top of a module defines."""
    if isinstance(node, ast.ClassDef | ast.FunctionDef):
        return [node.name]
    targets = node.targets if isinstance(node, ast.Assign) else [getattr(node, "target", None)]
    inner = [
        part for target in targets for part in (target.elts if isinstance(target, ast.Tuple) else [target])
    ]
    return [target.id for target in inner if isinstance(target, ast.Name)]


def _comment_above(module: ModuleType, name: str) -> str:
    """Return the comment directly above the statement that defines a name; empty if there is none."""
    lines = Path(inspect.getsourcefile(module) or "").read_text(encoding="utf-8").splitlines()
    for node in _source(module).body:
        if name in _defined(node):
            first = node.lineno - 1
            begin = first
            while begin > 0 and lines[begin - 1].startswith("# "):
                begin -= 1
            return " ".join(line.removeprefix("# ") for line in lines[begin:first])
    return ""

"""Generated pages of the site have every name of the registries, and every public name of the modules."""

import ast
import re
from dataclasses import replace
from importlib import import_module
from pathlib import Path

import gymnasium
import pytest

from experiments.catalogue import COLLECTIONS, SUITES
from experiments.scoring.files import ScoreFileError, write_scores
from experiments.scoring.score import ScoreRow, digest_of_runs
from experiments.site import environments, registries
from experiments.site.commands import COMMANDS, WITHOUT_HELP, commands_at_the_top
from experiments.site.environments import VERSIONS, environment_page, reference_scores
from experiments.site.pages import generated_pages
from experiments.site.reference import PAGES, public_names, reference_pages
from helpers.loops import looped
from swarm_gym.action import ACTIONS
from swarm_gym.controllers import CONTROLLERS
from swarm_gym.observation import OBSERVATIONS
from swarm_gym.optimizers import ALL_OPTIMIZERS, OPTIMIZERS, get_optimizer
from swarm_gym.registration import environment_id
from swarm_gym.reward import REWARDS
from swarm_gym.scenarios import FAMILIES, SCENARIOS
from swarm_gym.settings import Settings
from swarm_gym.training.presets import preset_names

pytest.importorskip("tyro", reason="needs the extra `study`")

ROOT = Path(__file__).parents[3]
# Documents whose code imports public names only.
DOCUMENTS = (
    "README.md",
    *(f"docs/{name}.md" for name in ("guide", "own-code", "recipes")),
    *sorted(path.relative_to(ROOT).as_posix() for path in ROOT.glob("docs/planning*.md")),
)


@pytest.fixture(scope="module")
def pages():
    return generated_pages(ROOT)


@pytest.fixture(scope="module")
def reference():
    return "\n".join(reference_pages().values())


def first_cells(page):
    """Return the names in the first column of all tables of a page."""
    return set(re.findall(r"^\| \[?`([^`]+)`", page, re.MULTILINE))


def test_every_registered_environment_has_a_page(pages):
    registered = {name for name in gymnasium.registry if name.startswith("swarm_gym/")}
    titles = {
        pages[f"environments/{name}.md"].partition("\n")[0].removeprefix("# ").strip("`")
        for name in ALL_OPTIMIZERS
    }
    assert titles == registered
    assert first_cells(pages["environments/index.md"]) == registered


@pytest.mark.parametrize("optimizer", OPTIMIZERS)
def test_the_page_of_an_environment_has_its_names(optimizer, pages):
    listed = first_cells(pages[f"environments/{optimizer}.md"])
    options = {name for name in Settings.__dataclass_fields__ if name != "knobs"}
    assert listed >= {*ACTIONS, *OBSERVATIONS, *REWARDS, *options, *get_optimizer(optimizer).parameters}
    assert {"render_mode", "best_path", "optimality_gap", "v0"} <= listed


@pytest.mark.parametrize("name", ["natural", "paced", "sourced"])
def test_the_page_of_an_environment_states_the_shape_of_actions(name, pages):
    env = gymnasium.make(environment_id("firefly"), action=name, max_evaluations=1000)
    assert (
        f"| `{name}` | {env.action_space.dtype} | {env.action_space.shape} |"
        in pages["environments/firefly.md"]
    )


def test_a_layout_that_an_optimizer_cannot_have_stands_there_with_the_reason(pages):
    assert "| `sourced` | – | – | refused: action 'sourced': smooth new" in pages["environments/glowworm.md"]
    lines = [line for line in pages["environments/firefly.md"].splitlines() if "refused:" in line]
    # Layouts of optimizers that begin anew, remember or have a distribution; of bit strings; of budgets.
    refused = ["restarts", "search", "distribution", "theory", "theory-scaled"]
    assert [name for line in lines if not (name := line.split("`")[1]).startswith("anytime")] == refused


def test_a_parameter_stands_there_with_symbol_default_range_and_unit(pages):
    line = "| `absorption` | gamma | 1 | [0, 1e+09] | – | decay of the attraction, per squared map unit |"
    assert line in pages["environments/generational-firefly.md"]
    assert "| `selection` | – | `brightest` | `brightest`, " in pages["environments/glowworm.md"]


def test_the_default_encoding_is_that_of_the_optimizer(pages):
    assert "| `encoding` | `'walk'` |" in pages["environments/ant-colony.md"]
    assert "| `encoding` | `'waypoints'` |" in pages["environments/firefly.md"]


def test_reference_scores_are_those_of_the_environment(tmp_path):
    row = ScoreRow(
        controller="fixed:60", environment="swarm_gym/Firefly-v0", scenario_set="case1", first_seed=7,
        num_seeds=10, gap=0.0312, evaluations=81767.2, feasible=0.2, digest="0123456789abcdef" * 4,
        runs_digest=digest_of_runs([1.0], [2]), fitness_of_runs=(1.0,), evaluations_of_runs=(2,),
    )  # fmt: skip
    other = replace(row, environment="swarm_gym/Glowworm-v0", controller="fixed:26", gap=0.5)
    write_scores(tmp_path / "tiny.csv", [row, other])
    page = environment_page("firefly", "case2", "fixed:16", tmp_path)
    assert "| tiny | `fixed:60` | `case1` | 10 from 7 | 3.12 % | 81,767 | 20% | `0123456789ab` |" in page
    assert "fixed:26" not in page
    assert "## Reference scores" not in environment_page("ant-colony", "case2", "fixed:16", tmp_path)


def test_a_table_of_scores_without_a_column_is_an_error(tmp_path):
    (tmp_path / "tiny.csv").write_text("environment,controller\nswarm_gym/Firefly-v0,fixed:60\n")
    with pytest.raises(
        ScoreFileError, match=r"tiny\.csv: lacks the columns .*digest.*; expected controller,"
    ):
        list(reference_scores(tmp_path, "swarm_gym/Firefly-v0"))


def test_a_version_without_a_line_is_an_error(monkeypatch):
    monkeypatch.setattr(environments, "VERSIONS", {"v1": VERSIONS["v0"]})
    with pytest.raises(ValueError, match="Firefly-v0: its version is not in"):
        environment_page("firefly", "case2", "fixed:16")


@pytest.mark.parametrize(
    ("page", "names"),
    [
        ("all-controllers", CONTROLLERS),
        ("all-scenarios", (*SCENARIOS, *FAMILIES)),
        ("all-layouts", (*ALL_OPTIMIZERS, *ACTIONS, *OBSERVATIONS, *REWARDS)),
        ("all-presets", preset_names()),
        ("all-suites", (*SUITES, *COLLECTIONS)),
    ],
)
def test_a_page_of_a_registry_has_all_of_its_names(page, names, pages):
    assert first_cells(pages[f"reference/{page}.md"]) == set(names)


def test_every_controller_is_described(pages):
    rows = re.findall(r"^\| `([\w-]+)` \| ([^|]+) \|", pages["reference/all-controllers.md"], re.MULTILINE)
    assert {name for name, text in rows if text.strip(" –")} == set(CONTROLLERS)


def test_examples_of_controllers_are_of_families_that_exist():
    assert set(registries.EXAMPLES) <= set(CONTROLLERS)
    assert all(text.startswith(name) for name, text in registries.EXAMPLES.items())


def test_every_command_is_on_the_page_of_commands(pages):
    titles = set(re.findall(r"^### `([\w.]+)`$", pages["reference/commands.md"], re.MULTILINE))
    assert titles == {name for names in COMMANDS.values() for name in names} | set(
        commands_at_the_top()
    ) - set(WITHOUT_HELP)
    assert "--target-kl" in pages["reference/commands.md"]


@looped("module", [name for page in PAGES.values() for name in page.modules])
def test_every_public_name_of_a_module_is_in_the_reference(module, reference):
    for name in public_names(import_module(module)):
        directive = rf"^\.\. (?:auto\w+|py:data):: {module}\.{name}$"
        link = rf":py:obj:`{name} <[\w.]+>`"
        assert re.search(directive, reference, re.MULTILINE) or re.search(link, reference), f"{module}.{name}"


@pytest.mark.parametrize("document", DOCUMENTS)
def test_what_the_documents_import_is_in_the_reference(document):
    shown = {id(getattr(import_module(module), name)) for module, name in names_in_the_reference()}
    found = list(imports(ROOT / document))
    missing = [
        f"{module}.{name}" for module, name in found if id(getattr(import_module(module), name)) not in shown
    ]
    assert missing == []


def names_in_the_reference():
    for page in PAGES.values():
        for module in page.modules:
            yield from ((module, name) for name in public_names(import_module(module)))
        for module, names in page.parts.items():
            yield from ((module, name) for name in names)


def imports(document):
    """Yield module and name of each `from ... import ...` of this project in the code of a document."""
    for code in re.findall(r"```python\n(.*?)```", document.read_text(encoding="utf-8"), re.DOTALL):
        for node in ast.walk(ast.parse(code)):
            if isinstance(node, ast.ImportFrom) and str(node.module).split(".")[0] in ("swarm_gym", "agents"):
                for alias in node.names:
                    if isinstance(getattr(import_module(node.module), alias.name), type(ast)):
                        continue  # a module
                    yield node.module, alias.name


def test_documents_outside_of_docs_have_pages_with_links_that_work_there(pages):
    assert "](architecture.md#words)" in pages["contributing.md"]
    assert "](scenarios-grids.md#cells-files-and-paths)" in pages["contributing.md"]
    assert "](newcomers.md)" in pages["changelog.md"]
    assert "](docs/" not in pages["contributing.md"] + pages["changelog.md"]

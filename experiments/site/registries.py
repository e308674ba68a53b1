"""Pages that list registries: controllers, scenarios, layouts, rewards, optimizers, presets and suites."""

from collections.abc import Callable
from functools import partial
from inspect import getmodule
from typing import Any

from experiments.catalogue import COLLECTIONS, SUITES
from experiments.site.markdown import code, first_sentence, listed, table
from swarm_gym.action import ACTIONS
from swarm_gym.controllers import CONTROLLERS
from swarm_gym.observation import OBSERVATIONS
from swarm_gym.optimizers import ALL_OPTIMIZERS, get_optimizer
from swarm_gym.registration import environment_id
from swarm_gym.reward import REWARDS
from swarm_gym.scenarios import FAMILIES, SCENARIOS
from swarm_gym.training.presets import PRESETS, load_preset, preset_names

# Names that controllers have besides their parameters, each with an example.
EXAMPLES = {
    "fixed": "fixed:60",
    "spsfa": "spsfa:growth=500",
    "spsfa-tip": "spsfa-tip:growth=500,decay=0.1",
    "linear-reduction": "linear-reduction:start=120",
    "lpsr": "lpsr:start=120",
    "nlpsr": "nlpsr:start=120",
    "open-loop": "open-loop:three-cases",
    "reacting-loop": "reacting-loop:dynamic-reacting/0@1",
    "learned": "learned:three-cases/0@1",
    "together": "together:three-cases@1",
    "tuned": "tuned:three-cases",
    "distilled": "distilled:three-cases",
}


def controllers_page() -> str:
    """Return the page of all families of controllers."""
    rows = [
        (code(name), _described(name, make), code(EXAMPLES.get(name, name)))
        for name, make in CONTROLLERS.items()
    ]
    return f"""\
# All controllers

A controller decides the population size and the repair degree. Give its name to
`swarm_gym.controllers.make_controller`, or to the option `--controllers` of a command.
`swarm_gym.controllers.names` says how names are built. A controller of your own is `module:attribute`, see
[own code](../own-code.md).

{table(("name", "controller", "example"), rows)}
"""


def scenarios_page() -> str:
    """Return the page of all scenarios and their families."""
    single = [(code(name), first_sentence(make)) for name, make in SCENARIOS.items()]
    families = [
        (
            code(name),
            _module_sentence(family.make),
            code(family.usage),
            listed(family.samples) or "–",
        )
        for name, family in FAMILIES.items()
    ]
    return f"""\
# All scenarios

Give one of these names as the option `scenario`. [Scenarios](../scenarios.md) describes them.

## Single scenarios

{table(("name", "scenario"), single)}

## Families

A family stands for many scenarios, whose names begin with that of the family.

{table(("family", "scenarios", "form of the names", "examples"), families)}
"""


def layouts_page() -> str:
    """Return the page of all optimizers, layouts and rewards."""
    optimizers = [
        (
            code(name),
            first_sentence(get_optimizer(name)),
            f"[`{environment_id(name)}`](../environments/{name}.md)",
        )
        for name in ALL_OPTIMIZERS
    ]
    actions = [
        (code(name), layout.size, _yes(layout.extended), _yes(layout.sourced))
        for name, layout in ACTIONS.items()
    ]
    observations = [
        (code(name), len(layout.features), "; ".join(feature.name for feature in layout.features))
        for name, layout in OBSERVATIONS.items()
    ]
    rewards = [
        (code(name), first_sentence(reward).removeprefix("Return ")) for name, reward in REWARDS.items()
    ]
    return f"""\
# All optimizers, layouts and rewards

These names are values of the options `optimizer` of commands, and `action`, `observation` and `reward` of
environments.

## Optimizers

{table(("name", "optimizer", "environment"), optimizers)}

## Action layouts

{table(("name", "scale of the size", "parameters of the optimizer", "source of new members"), actions)}

## Observation layouts

{table(("name", "numbers", "meaning"), observations)}

## Reward functions

{table(("name", "reward of one iteration"), rewards)}
"""


def presets_page() -> str:
    """Return the page of all presets of trainings."""
    rows = []
    for name in preset_names():
        config = load_preset(name)
        scenarios = config.scenarios
        rows.append(
            (
                code(name),
                _comment(name),
                code(config.algorithm.name),
                listed(scenarios[:3]) + (f" and {len(scenarios) - 3} more" if len(scenarios) > 3 else ""),
                code(config.action),
                code(config.observation),
                f"{config.total_steps:,}",
            )
        )
    header = ("name", "training", "algorithm", "scenarios", "action", "observation", "steps")
    return f"""\
# All presets

A preset is a training configuration: `python -m agents.train --preset <name>`. Other options of the command
change it.

{table(header, rows)}
"""


def suites_page() -> str:
    """Return the page of all suites of experiments."""
    rows = [
        (
            code(name),
            _count(suite.controllers, "controller"),
            _count(suite.scenarios, "scenario"),
            suite.num_seeds,
            code(suite.baseline),
            listed(suite.tables),
        )
        for name, suite in SUITES.items()
    ]
    collections = [(code(name), listed(suites)) for name, suites in COLLECTIONS.items()]
    header = ("name", "controllers", "scenarios", "seeds for each scenario", "baseline", "tables")
    return f"""\
# All suites

A suite runs all its controllers on the same pairs of scenario and seed:
`python -m experiments.evaluate --suite <name>`.

{table(header, rows)}

## Collections

A collection is the name of several suites.

{table(("name", "suites"), collections)}
"""


REGISTRIES: dict[str, Callable[[], str]] = {
    "all-controllers": controllers_page,
    "all-scenarios": scenarios_page,
    "all-layouts": layouts_page,
    "all-presets": presets_page,
    "all-suites": suites_page,
}


def _described(name: str, make: Any) -> str:
    """Return the first sentence on a family of controllers: of its class, or else of its function."""
    if isinstance(make, partial):
        described = _described(name, make.func)
        return f"{described} ({', '.join(f'{key}={value}' for key, value in make.keywords.items())})"
    owner = getattr(make, "__self__", None)
    if owner is None and make.__doc__ is None:
        # A function that closes over the class of the controller.
        owner = next(cell.cell_contents for cell in make.__closure__ if isinstance(cell.cell_contents, type))
    return first_sentence(owner or make).removeprefix("Return ")


def _module_sentence(make: Callable[..., Any]) -> str:
    """Return the first sentence of the module in which a family's scenarios are made."""
    plain = make.func if isinstance(make, partial) else make
    return first_sentence(getmodule(plain))


def _comment(preset: str) -> str:
    """Return the comment at the beginning of a preset's file."""
    path = PRESETS.find(preset)
    assert path is not None, "a preset has a file"
    lines = path.read_text(encoding="utf-8").splitlines()
    comment = []
    for line in lines:
        if not line.startswith("#"):
            break
        comment.append(line.removeprefix("#").strip())
    return " ".join(comment).removesuffix(".") or "–"


def _count(names: tuple[str, ...], noun: str) -> str:
    return code(names[0]) if len(names) == 1 else f"{len(names)} {noun}s"


def _yes(value: bool) -> str:
    return "decided" if value else "fixed"

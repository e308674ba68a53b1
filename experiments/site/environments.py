"""Pages of environments: one for each registered id, made from its class and the registries."""

import inspect
import sys
from collections.abc import Iterator
from dataclasses import MISSING, fields
from pathlib import Path
from typing import Any

from experiments.scoring.files import read_scores
from experiments.scoring.score import ScoreRow
from experiments.site.markdown import code, entries, first_sentence, linked, listed, prose, table, topic
from swarm_gym.action import ACTIONS, make_action
from swarm_gym.env import SwarmEnv
from swarm_gym.errors import SettingError
from swarm_gym.kinds import KINDS
from swarm_gym.observation import OBSERVATIONS
from swarm_gym.optimizers import ALL_OPTIMIZERS, get_optimizer
from swarm_gym.optimizers.optimizer import Optimizer
from swarm_gym.registration import environment_id
from swarm_gym.reset_options import RESET_OPTIONS
from swarm_gym.reward import NEED_A_BUDGET, NEED_AN_OPTIMUM, NEED_ROBOTS, REWARDS
from swarm_gym.settings import Settings

# By version, the release that brought it and what is new in it; docs/versions.md has the rule.
VERSIONS = {"v0": ("0.1.0", "The first version.")}
SCENARIO = "case1"
# A budget of evaluations, which paced actions need.
BUDGET = 100_000
# What the scenarios of an environment must have, by the name of the reward.
NEEDS_OF_REWARDS = {
    **dict.fromkeys(NEED_AN_OPTIMUM, "a known optimum"),
    **dict.fromkeys(NEED_ROBOTS, "robots that drive"),
    **dict.fromkeys(NEED_A_BUDGET, "a budget of evaluations"),
}
# Digits of a digest that tell one from the others.
SHOWN_DIGITS = 12

SCORES = """\
## Reference scores

Means over all seeds of a row: gap to the optimum, evaluations of an episode, and share of the episodes whose
best path is free. The digest names the controller.

{table}

"""

PAGE = """\
# `{id}`

{summary}.

![A run of {name} on {animated_on}](animations/{name}.gif)

*One run on `{animated_on}` with {controller}, one picture for each iteration: an example, no measurement.
Black is the best path so far; blue members are free, orange ones collide.*

```python
import gymnasium
import swarm_gym

env = gymnasium.make("{id}", scenario="{scenario}")
observation, info = env.reset(seed=0)
```

## What it models

{model}

{properties}

## Actions

The option `action` chooses a layout. An action is an array with these numbers, each in its range.
`swarm_gym.action` explains the layouts. [Own code](../own-code.md) shows a layout of your own.

{actions}

## Observations

The option `observation` chooses a layout; `paper+rich` joins two of them. The bounds below are those on
`{scenario}`. `swarm_gym.observation` explains the layouts.

{observations}

## Options

These are options of `gymnasium.make`; lengths are in map units. An option without effect on the kind of
map is refused.

{options}

Options of `reset`: {reset_options}.

## Parameters of the optimizer

They are options of `gymnasium.make`, too. A parameter with a range under *set by actions* is set at every
iteration by the layouts `extended` and `sourced`.

{parameters}

## Rewards

The option `reward` chooses one. The default is {reward}.

{rewards}

## Endings

{episode}

## Info

{info}

## Maps

Maps of circles and polygons are analytic maps. A map that changes during an episode runs where the maps
between its events run. [Scenarios](../scenarios.md) has the names of maps. The [gallery](../gallery.md)
shows each optimizer on one map of each family.

{maps}

{scores}## Versions

{versions}

[The rule for versions](../versions.md) says when `-v0` becomes `-v1`.
"""


def environment_page(optimizer: str, animated_on: str, controller: str, scores: Path | None = None) -> str:
    """Return the Markdown page of an optimizer's environment.

    Args:
        optimizer: name of the optimizer.
        animated_on: scenario of the animation.
        controller: controller of the animation.
        scores: folder of the tables of reference scores, one CSV file for each suite; None for none.
    """
    cls = get_optimizer(optimizer)
    name, module = environment_id(optimizer), sys.modules[cls.__module__]
    found = list(reference_scores(scores, name)) if scores is not None else []
    return PAGE.format(
        id=name,
        name=optimizer,
        summary=first_sentence(module),
        animated_on=animated_on,
        controller=code(controller),
        scenario=SCENARIO,
        # The summary is the first paragraph of the module's docstring.
        model=linked("\n\n".join([prose(cls), *prose(module).split("\n\n")[1:]])),
        properties=_properties(cls),
        actions=_actions(optimizer),
        observations=_observations(optimizer),
        options=_options(cls),
        reset_options=listed(RESET_OPTIONS),
        parameters=_parameters(cls),
        reward=code(Settings.reward),
        rewards=_rewards(),
        episode=topic(SwarmEnv, "Episode"),
        info=topic(SwarmEnv, "Info"),
        maps=_maps(cls),
        scores=_scores(found),
        versions=_versions(name),
    )


def index_page() -> str:
    """Return the page that lists all environments."""
    rows = [
        (f"[`{environment_id(name)}`]({name}.md)", first_sentence(get_optimizer(name)))
        for name in ALL_OPTIMIZERS
    ]
    pages = "\n".join(ALL_OPTIMIZERS)
    return f"""\
# Environments

Each optimizer is an environment of its own; all of them have the same interface. Choose one here to see
its spaces, options, parameters and rewards.

{table(("environment", "optimizer"), rows)}

```{{toctree}}
:hidden:

{pages}
```
"""


def reference_scores(folder: Path, environment: str) -> Iterator[tuple[str, ScoreRow]]:
    """Yield the suite and the row of each score of an environment, from a folder of files of scores.

    Raises:
        ScoreFileError: if a file cannot be read; the message names it.
    """
    for path in sorted(folder.glob("*.csv")):
        yield from ((path.stem, row) for row in read_scores(path) if row.environment == environment)


def _properties(cls: type[Optimizer]) -> str:
    rows: list[tuple[str, object]] = [
        ("option `optimizer` of commands", code(cls.name)),
        ("smallest population", cls.smallest_population),
        ("evaluations of a member in an iteration, about", f"{cls.evaluations_per_member:g}"),
        ("encodings, the default first", listed(cls.encodings)),
        ("takes `initial_population` in `reset`", "yes" if cls.adopts else "no"),
    ]
    return table(("property", "value"), rows)


def _actions(optimizer: str) -> str:
    rows: list[tuple[object, ...]] = []
    for name in ACTIONS:
        try:
            env = SwarmEnv(optimizer, scenario=SCENARIO, action=name, max_evaluations=BUDGET)
        except SettingError as error:
            rows.append((code(name), "–", "–", f"refused: {error}"))
            continue
        action = make_action(env.settings, get_optimizer(optimizer))
        space = action.space
        numbers = zip(action.labels, space.low, space.high, strict=True)
        text = "; ".join(f"{label} in {range_of(low, high)}" for label, low, high in numbers)
        rows.append((code(name), str(space.dtype), str(space.shape), text))
    return table(("layout", "dtype", "shape", "numbers"), rows)


def _observations(optimizer: str) -> str:
    rows: list[tuple[object, ...]] = []
    for name, layout in OBSERVATIONS.items():
        try:
            env = SwarmEnv(optimizer, scenario=SCENARIO, observation=name)
        except SettingError as error:
            rows.append((code(name), "–", "–", f"refused: {error}"))
            continue
        space: Any = env.observation_space
        numbers = list(zip(layout.features, space.low, space.high, strict=True))
        base = base_of(name)
        if base:
            numbers = numbers[len(OBSERVATIONS[base].features) :]
        text = "; ".join(f"{feature.name} in {range_of(low, high)}" for feature, low, high in numbers)
        rows.append((code(name), space.dtype, space.shape, f"all of `{base}`; {text}" if base else text))
    return table(("layout", "dtype", "shape", "numbers"), rows)


def base_of(name: str) -> str:
    """Return the longest other layout whose features a layout begins with; empty if there is none."""
    features = OBSERVATIONS[name].features
    begun = [
        other
        for other, layout in OBSERVATIONS.items()
        if other != name and features[: len(layout.features)] == layout.features
    ]
    return max(begun, key=lambda other: len(OBSERVATIONS[other].features), default="")


def range_of(low: float, high: float) -> str:
    """Return the interval of two bounds."""
    return f"[{low:.4g}, {high:.4g}]"


def _options(cls: type[Optimizer]) -> str:
    meanings = entries(Settings, "Attributes")
    own = {"encoding": cls.encodings[0]}
    rows = [
        (code(field.name), code(repr(own.get(field.name, field.default))), meanings[field.name])
        for field in fields(Settings)
        if field.default is not MISSING
    ]
    rendering = inspect.signature(SwarmEnv).parameters
    for name, meaning in entries(SwarmEnv, "Args").items():
        if name.startswith("render"):
            rows.append((code(name), code(repr(rendering[name].default)), meaning))
    return table(("option", "default", "meaning"), rows)


def _parameters(cls: type[Optimizer]) -> str:
    rows = []
    for name, parameter in cls.parameters.items():
        if parameter.choices:
            default, span = code(parameter.choices[0]), listed(parameter.choices)
        else:
            default, span = f"{parameter.default:g}", f"[{parameter.low:g}, {parameter.high:g}]"
        decided = "–" if parameter.decided is None else "[{:g}, {:g}]".format(*parameter.decided)
        rows.append((code(name), parameter.symbol or "–", default, span, decided, parameter.meaning))
    header = ("parameter", "symbol in the paper", "default", "values", "set by actions", "meaning and unit")
    return table(header, rows)


def _rewards() -> str:
    rows = [
        (
            code(name),
            first_sentence(reward).removeprefix("Return "),
            NEEDS_OF_REWARDS.get(name, "–"),
        )
        for name, reward in REWARDS.items()
    ]
    return table(("reward", "value of one iteration", "needs"), rows)


def _maps(cls: type[Optimizer]) -> str:
    rows = []
    for kind in KINDS.values():
        possible = [encoding for encoding in cls.encodings if encoding in kind.options]
        rows += [(kind.name, code(each), listed(kind.options[each]) or "none") for each in possible]
        if not possible:
            rows.append((kind.name, "does not run there", "–"))
    return table(("kind of map", "encoding", "options of the map"), rows)


def _scores(rows: list[tuple[str, ScoreRow]]) -> str:
    if not rows:
        return ""
    shown = [
        (
            suite,
            code(row.controller),
            code(row.scenario_set),
            f"{row.num_seeds} from {row.first_seed}",
            f"{100.0 * row.gap:.2f} %",
            f"{row.evaluations:,.0f}",
            f"{row.feasible:.0%}",
            code(row.digest[:SHOWN_DIGITS]),
        )
        for suite, row in rows
    ]
    header = ("suite", "controller", "scenarios", "seeds", "gap", "evaluations", "free", "digest")
    return SCORES.format(table=table(header, shown))


def _versions(name: str) -> str:
    """Return the table of versions.

    Raises:
        ValueError: if the version of the id is not among those that are listed.
    """
    current = name.rpartition("-")[2]
    if current not in VERSIONS:
        raise ValueError(f"{name}: its version is not in experiments/site/environments.py")
    return table(("version", "release", "change"), [(code(v), *rest) for v, rest in VERSIONS.items()])

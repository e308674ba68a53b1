"""Tables of docs/layouts.md: every layout and reward, its numbers and ranges, and whom it is for."""

from collections.abc import Mapping
from typing import Any

from experiments.site.environments import BUDGET, NEEDS_OF_REWARDS, SCENARIO, base_of, range_of
from experiments.site.markdown import code, first_sentence, table
from experiments.tables.document import Block
from swarm_gym.action import ACTIONS, make_action
from swarm_gym.env import SwarmEnv
from swarm_gym.observation import OBSERVATIONS, Observation
from swarm_gym.optimizers import get_optimizer
from swarm_gym.reward import NEED_BITS, REWARDS

OPTIMIZER, ON_BITS, WITH_RESTARTS = "firefly", "one-plus-lambda-lambda", "cma-es"
ACTIONS_ARE_FOR: Mapping[str, str] = {
    "natural": "rules; the default of `gymnasium.make`",
    "normalised": "policies that correct a controller of size and phi",
    "paced": "learners with a budget of evaluations",
    "centred": "learners; the default of `make_vec`",
    "extended": "rules that decide parameters of the optimizer, too",
    "extended-normalised": "policies that correct such a rule",
    "extended-paced": "learners of parameters, with a budget",
    "extended-centred": "learners of parameters",
    "sourced": "rules that decide sources of new members, too",
    "sourced-normalised": "policies that correct a controller of sources",
    "sourced-paced": "learners of sources, with a budget",
    "sourced-centred": "learners of sources",
}
OBSERVATIONS_ARE_FOR: Mapping[str, str] = {
    "paper": "the paper's rules; the default of `gymnasium.make`",
    "scaled": "networks that see what the paper's rules see",
    "extended": "learners; the default of `make_vec`",
    "rich": "learners that shall see progress and the budget",
    "priced": "policies for every price",
    "corridors": "learners of sources on maps",
    "jumps": "learners on maps that change, which see what events do",
    "told": "learners on maps that change, which are told when events come",
    "named": "one policy for several optimizers",
    "restarts": "rules of sizes that follow restarts",
    "distribution": "the rule of PSA-CMA-ES",
    "search": "learners with CMA-ES or differential evolution",
    "theory": "the rules of OneMax",
    "theory-scaled": "learners on OneMax; the default of `make_vec` there",
}


def actions_block(_: object = None) -> str:
    """Return the table of action layouts, with the numbers of fireflies."""
    rows = []
    for name in ACTIONS:
        env = SwarmEnv(OPTIMIZER, scenario=SCENARIO, action=name, max_evaluations=BUDGET)
        action = make_action(env.settings, get_optimizer(OPTIMIZER))
        numbers = zip(action.labels, action.space.low, action.space.high, strict=True)
        said = "; ".join(f"{label} in {range_of(low, high)}" for label, low, high in numbers)
        rows.append((code(name), ACTIONS_ARE_FOR.get(name, "–"), said))
    return table(("action", "for", "numbers"), rows)


def observations_block(_: object = None) -> str:
    """Return the table of observation layouts, with the numbers of fireflies where these have them."""
    rows = []
    for name, layout in OBSERVATIONS.items():
        optimizer = _seen_by(layout)
        where: dict[str, Any] = {} if optimizer == ON_BITS else {"scenario": SCENARIO}
        env = SwarmEnv(optimizer, observation=name, **where)
        space: Any = env.observation_space
        numbers = list(zip(layout.features, space.low, space.high, strict=True))
        base = base_of(name)
        numbers = numbers[len(OBSERVATIONS[base].features) :] if base else numbers
        said = "; ".join(f"{feature.name} in {range_of(low, high)}" for feature, low, high in numbers)
        said = f"all of `{base}`; {said}" if base else said
        rows.append((code(name), OBSERVATIONS_ARE_FOR.get(name, "–"), len(layout.features), said))
    return table(("observation", "for", "numbers", "meaning"), rows)


def _seen_by(layout: Observation) -> str:
    """Return the name of an optimizer that a layout can be used with."""
    if any(feature.needs_bits for feature in layout.features):
        return ON_BITS
    special = any(feature.needs_restarts or feature.needs_search for feature in layout.features)
    return WITH_RESTARTS if special else OPTIMIZER


def rewards_block(_: object = None) -> str:
    """Return the table of rewards."""
    needs = {**NEEDS_OF_REWARDS, **dict.fromkeys(NEED_BITS, "bit strings")}
    rows = [
        (code(name), first_sentence(reward).removeprefix("Return "), needs.get(name, "–"))
        for name, reward in REWARDS.items()
    ]
    return table(("reward", "value of one iteration", "needs"), rows)


LAYOUT_BLOCKS: Mapping[str, Block] = {
    "actions": actions_block,
    "observations": observations_block,
    "rewards": rewards_block,
}

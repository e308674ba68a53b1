"""The rows of controllers: the paper's rules, constants, blind schedules, policies and blinded policies."""

from collections.abc import Sequence

from agents.evaluation.masking import load_blinded
from experiments.studies.terrain.rows import (
    PLANNED,
    AnyRow,
    ControlledRow,
    PlannedRow,
    peer_rows,
    swarm_rows,
)
from swarm_gym.controllers import make_controller
from swarm_gym.controllers.controller import Controller, SizeLimits
from swarm_gym.controllers.learned.policy_file import policies_of
from swarm_gym.controllers.names import BLINDED, ControllerName
from swarm_gym.controllers.open_loop import packaged_open_loops
from swarm_gym.optimizers import get_optimizer

EVALUATIONS, ITERATIONS = 2_500, 220  # of an episode of the trainings
LARGEST_SIZE = 100  # that the trainings allow
# Recipes of policies, by optimizer, encoding and what they decide.
SIZES_DECIDED, SOURCES_DECIDED = "size and phi", "with sources"
RECIPES = {
    ("differential-evolution", "waypoints", SIZES_DECIDED): "terrain-sizes",
    ("differential-evolution", "waypoints", SOURCES_DECIDED): "terrain-sourced",
    ("differential-evolution", "shifted", SOURCES_DECIDED): "terrain-shifted",
    ("firefly", "waypoints", SIZES_DECIDED): "terrain-firefly-sizes",
    ("firefly", "waypoints", SOURCES_DECIDED): "terrain-firefly-sourced",
}
# Open loops of one knot, which policies of a recipe correct, and from which its blind schedule was tuned.
CONSTANTS = {
    "terrain-sizes": "terrain-sizes-start",
    "terrain-sourced": "terrain-start",
    "terrain-shifted": "terrain-start",
    "terrain-firefly-sizes": "terrain-firefly-sizes-start",
    "terrain-firefly-sourced": "terrain-firefly-start",
}
# The paper's rules, as printed and with parameters tuned over terrain with even waypoints. Tuned with shifted
# ones, with 1.5 million steps, they had a larger objective on 24 terrains for validation, by 0.2.
RULE = "spsfa-tip"
TUNED_RULES = {
    ("firefly", "waypoints"): "tuned:terrain-firefly-schedule",
    ("differential-evolution", "waypoints"): "tuned:terrain-schedule",
    ("differential-evolution", "shifted"): "tuned:terrain-schedule",
}

# A fall by iterations, from the population size that mealpy begins with, and the iterations of its episodes
# with `EVALUATIONS`. In L-SHADE's paper the size falls with the evaluations spent.
REDUCTION, REDUCING_ITERATIONS = "linear-reduction:start=100,smallest=4", 48


def rule_rows() -> list[AnyRow]:
    """Return the rows of a linear reduction, and of the paper's rules in fireflies and in L-SHADE."""
    found: list[AnyRow] = [
        ControlledRow(
            "linear reduction",
            "differential-evolution",
            source,
            (REDUCTION,),
            evaluations=EVALUATIONS,
            iterations=REDUCING_ITERATIONS,
            encoding=encoding,
        )
        for encoding, source in (("waypoints", "uniform"), ("waypoints", "guided"), ("shifted", "guided"))
    ]
    found.append(ControlledRow("SPSFA-TIP", "firefly", "uniform", (RULE,)))
    for (optimizer, encoding), tuned in TUNED_RULES.items():
        for label, name in (("SPSFA-TIP", RULE), ("SPSFA-TIP, tuned", tuned)):
            found.append(ControlledRow(label, optimizer, "guided", (name,), encoding=encoding))
    return found


def blind_rows() -> list[AnyRow]:
    """Return the rows of controllers that see nothing: constants and tuned schedules."""
    found: list[AnyRow] = []
    for (optimizer, encoding, decided), recipe in RECIPES.items():
        constants = (f"open-loop:{CONSTANTS[recipe]}",)
        label = f"constants, {decided}"
        found.append(ControlledRow(label, optimizer, "guided", constants, encoding=encoding))
        if (tuned := f"{recipe}-tuned") in packaged_open_loops():
            label = f"blind schedule, {decided}"
            found.append(_trained(label, optimizer, encoding, (f"open-loop:{tuned}",)))
    return found


def learned_rows() -> list[AnyRow]:
    """Return the rows of the policies that are there, and of these policies blinded."""
    found: list[AnyRow] = []
    for (optimizer, encoding, decided), recipe in RECIPES.items():
        policies = policies_of(recipe)
        for family, label in (("learned", "learned"), (BLINDED, "learned, blinded")):
            if policies:
                names = tuple(f"{family}:{name}" for name in policies)
                found.append(_trained(f"{label}, {decided}", optimizer, encoding, names))
    return found


def rows() -> list[AnyRow]:
    """Return all rows of this study."""
    planned = [PlannedRow(encoding) for encoding in PLANNED]
    return [*swarm_rows(), *rule_rows(), *blind_rows(), *learned_rows(), *peer_rows(), *planned]


def controller_of(row: ControlledRow, name: str, evaluations: int) -> Controller:
    """Return a controller of a row, for episodes of its optimizer with an evaluation budget.

    Knots of schedules, also of those that policies correct, lie as far apart as episodes are longer. Blinded
    policies have the mean inputs of such episodes.
    """
    parts = ControllerName.parse(name)
    longer = row.iterations_of(evaluations) / row.iterations if row.iterations else 1.0
    if parts.family == BLINDED:
        return load_blinded(parts.argument, longer=longer)
    return _by_name(row, name).stretched(longer)


def _by_name(row: ControlledRow, name: str) -> Controller:
    parts = ControllerName.parse(name)
    if parts.family == "learned":
        return make_controller(name)
    smallest = max(2, get_optimizer(row.optimizer).smallest_population)
    largest = LARGEST_SIZE if parts.family in ("open-loop", "tuned") else SizeLimits().largest
    return make_controller(name, SizeLimits(smallest, largest))


def _trained(label: str, optimizer: str, encoding: str, controllers: Sequence[str]) -> ControlledRow:
    budget = EVALUATIONS, ITERATIONS
    return ControlledRow(label, optimizer, "guided", tuple(controllers), *budget, encoding=encoding)

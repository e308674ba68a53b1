"""The controllers whose gaps stand in the tables of this study."""

import math
from typing import NamedTuple

import numpy as np

from experiments.runs.episode import controller_of as controller_of_name
from experiments.studies.controllers import packaged_seeds
from experiments.studies.strong.grounds import COMPARED
from experiments.studies.strong.published import EVALUATIONS
from swarm_gym.controllers import SizeLimits, make_controller
from swarm_gym.controllers.controller import Controller
from swarm_gym.controllers.learned.together import load_together
from swarm_gym.controllers.names import BLINDED
from swarm_gym.controllers.size_rules import LinearReduction, NonLinearReduction

CMA_ES, L_SHADE = "cma-es", "differential-evolution"
CONSTANTS = (10, 20, 40, 80, 160)
RULES = ("ipop", "bipop", "psa")  # begin with the default size in ten dimensions
# Recipes of the policies of each optimizer, and how the tables call them.
RECIPES = {
    CMA_ES: {
        "cma-search": "learned, evolution",
        "cma-search-longer": "learned, evolution, longer",
        "cma-search-ppo": "learned, PPO",
        "cma-search-restarts": "learned from early restarts",
        "both-search": "learned on both optimizers",
    },
    L_SHADE: {"lshade-search": "learned, evolution", "both-search": "learned on both optimizers"},
}
# Ends the name of a row whose policies, of at least so many training seeds, decide together.
TOGETHER = ", together"
WITHOUT_SIGHT = ", blinded"  # ends the name of a row of blinded policies
BLINDED_TOGETHER = f"{BLINDED}:together:"  # begins the name of a controller of this study, before a recipe
LEAST_TOGETHER = 3
# Recipes whose policies run in dimensions that are not compared, too, and recipes whose policies run blinded.
ANY_DIMENSION = ("cma-search", "cma-search-longer", "cma-search-ppo")
BLINDED_TOO = ("cma-search-longer", "cma-search-restarts")
# Iterations of the episodes of each recipe: the budget at its smallest size.
ITERATIONS = {
    "cma-search": EVALUATIONS // 16,
    "cma-search-longer": EVALUATIONS // 10,
    "cma-search-ppo": EVALUATIONS // 16,
    "cma-search-restarts": EVALUATIONS // 10,
    "both-search": EVALUATIONS // 10,
    "lshade-search": EVALUATIONS // 8,
}
# Rivals that were tuned on the functions for training, with the objective and the iterations of a recipe.
TUNED = {
    CMA_ES: {"cma-constant": "constant tuned", "cma-schedule": "schedule tuned"},
    L_SHADE: {"lshade-constant": "constant tuned", "lshade-schedule": "schedule tuned"},
}
LIKE = {CMA_ES: "cma-search-longer", L_SHADE: "lshade-search"}
EARLY_RESTARTS = "CMA-ES, early restarts"  # a rule with a size of its own
# Sizes of L-SHADE: 18 for each dimension at first, as published, and four in the end.
FIRST_SIZE, LAST_SIZE = 180, 4
REDUCTIONS = (
    ("linear", "linear-reduction", LinearReduction),
    ("nlpsr", "nlpsr", NonLinearReduction),
)
LIMITS = SizeLimits()


class Entrant(NamedTuple):
    """One row of a table.

    Attributes:
        name: name of the row.
        optimizer: name of the optimizer.
        controllers: names of the controllers, one for each training seed.
        limits: smallest and largest population size; None for policies, which state their own.
        iterations: most iterations of an episode.
    """

    name: str
    optimizer: str
    controllers: tuple[str, ...]
    limits: SizeLimits | None = LIMITS
    iterations: int = EVALUATIONS // 4


def entrants() -> list[Entrant]:
    """Return all rows: constants, rules, what was tuned, and the policies there are, for both optimizers."""
    wide = SizeLimits(2, 2000)
    return [
        *(Entrant(f"CMA-ES, lambda {size}", CMA_ES, (f"fixed:{size}",)) for size in CONSTANTS),
        *(Entrant(f"CMA-ES, {rule.upper()}", CMA_ES, (rule,), wide) for rule in RULES),
        *_tuned("CMA-ES", CMA_ES),
        Entrant(EARLY_RESTARTS, CMA_ES, ("early-restarts",)),
        *(learned := _learned("CMA-ES", CMA_ES)),
        *(_blinded(one) for one in _of_recipes(learned, BLINDED_TOO)),
        Entrant(
            "L-SHADE, linear",
            L_SHADE,
            (_reduction("linear-reduction"),),
            LIMITS,
            _iterations_of(LinearReduction),
        ),
        Entrant(
            "L-SHADE, nlpsr", L_SHADE, (_reduction("nlpsr"),), LIMITS, _iterations_of(NonLinearReduction)
        ),
        Entrant("L-SHADE, N = 100", L_SHADE, ("fixed:100",)),
        *_tuned("L-SHADE", L_SHADE),
        *_learned("L-SHADE", L_SHADE),
    ]


def _tuned(name: str, optimizer: str) -> list[Entrant]:
    """Return the rows of the tuned rivals of an optimizer."""
    iterations = ITERATIONS[LIKE[optimizer]]
    return [
        Entrant(f"{name}, {label}", optimizer, (f"open-loop:{file}",), LIMITS, iterations)
        for file, label in TUNED[optimizer].items()
    ]


def _learned(name: str, optimizer: str) -> list[Entrant]:
    """Return the rows of the policies of an optimizer, as far as there are any, one by one and together."""
    rows = []
    for recipe, label in RECIPES[optimizer].items():
        row = Entrant(f"{name}, {label}", optimizer, packaged_seeds(recipe), None, ITERATIONS[recipe])
        if row.controllers:
            rows.append(row)
        if len(row.controllers) >= LEAST_TOGETHER:
            rows.append(row._replace(name=f"{row.name}{TOGETHER}", controllers=(f"together:{recipe}",)))
    return rows


def entrants_on_bbob(dimension: int) -> list[Entrant]:
    """Return the rows of CMA-ES in a dimension; rules begin with its default size.

    Sizes of L-SHADE here are for ten dimensions. Dimensions that are not compared have the default size, the
    tuned rivals and some policies alone.
    """
    size = default_size(dimension)
    rows = [Entrant("CMA-ES, default lambda", CMA_ES, (f"fixed:{size}",))]
    for one in entrants():
        (first, *_) = one.controllers
        if one.optimizer == CMA_ES:
            rows.append(one._replace(controllers=(f"{first}:start={size}",)) if first in RULES else one)
    if dimension in COMPARED:
        return rows
    kept = [rows[0], *(one for one in _of_recipes(rows, ANY_DIMENSION) if not one.name.endswith(TOGETHER))]
    return [one for one in rows if one.controllers[0].startswith("open-loop") or one in kept]


def _of_recipes(rows: list[Entrant], recipes: tuple[str, ...]) -> list[Entrant]:
    """Return the rows of the policies of some recipes, one by one and together."""
    labels = [f"CMA-ES, {RECIPES[CMA_ES][recipe]}" for recipe in recipes]
    return [one for one in rows if one.name.removesuffix(TOGETHER) in labels]


def default_size(dimension: int) -> int:
    """Return CMA-ES's default population size (Hansen's tutorial, 2016)."""
    return 4 + int(3 * math.log(dimension))


def _blinded(policies: Entrant) -> Entrant:
    names = (name.replace("together:", BLINDED_TOGETHER) for name in policies.controllers)
    controllers = tuple(name.replace("learned:", f"{BLINDED}:") for name in names)
    return policies._replace(name=f"{policies.name}{WITHOUT_SIGHT}", controllers=controllers)


def controller_of(entrant: Entrant, name: str) -> Controller:
    """Return a controller of a row by its name; policies, also blinded ones, are made once."""
    if name.startswith(BLINDED_TOGETHER):
        recipe = name.removeprefix(BLINDED_TOGETHER)
        return load_together(recipe, None, lambda policy, _: controller_of_name(f"{BLINDED}:{policy}"))
    return controller_of_name(name) if entrant.limits is None else make_controller(name, entrant.limits)


def _reduction(rule: str) -> str:
    return f"{rule}:start={FIRST_SIZE},smallest={LAST_SIZE}"


def _iterations_of(rule: type[LinearReduction]) -> int:
    """Return the fewest iterations in which the sizes of a reduction spend the budget."""
    for iterations in range(EVALUATIONS // FIRST_SIZE, EVALUATIONS // LAST_SIZE):
        fall = rule.fall(np.arange(iterations) / iterations)
        if FIRST_SIZE + np.rint(FIRST_SIZE + (LAST_SIZE - FIRST_SIZE) * fall).sum() >= EVALUATIONS:
            return iterations
    raise ValueError(f"no number of iterations spends {EVALUATIONS} evaluations")

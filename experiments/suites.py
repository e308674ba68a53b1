"""Suites: which controllers run on which scenarios, and what is made of the runs, as data.

To add one, enter it in `SUITES`. To add a controller to one, enter its name in the tuple; training seeds of a
recipe, `*training_seeds("ppo:three-cases", 10)`, are reported on together (see `experiments.groups`).
"""

from dataclasses import dataclass
from functools import cached_property

from experiments import parameter_study
from experiments.groups import numbered
from swarm_gym.checks import look_up

PAPER_TABLES = ("summary", "cases", "comparison", "reproduction")
PAPER_FIGURES = ("snapshots", "collision", "cases")
STUDY_TABLES = ("gaps", "differences", "front", "near-optimum")
STUDY_FIGURES = ("profiles", "front", "decisions")

# Seeds below 100 were looked at when a hyper-parameter was chosen; all below 100,000 are for tests.
FRESH_SEEDS = 10_000


@dataclass(frozen=True)
class Family:
    """Controllers that trade quality for cost, reported as one front.

    Attributes:
        name: as printed.
        groups: keys of groups of controllers; figures connect them in the order of their evaluations.
    """

    name: str
    groups: tuple[str, ...]


@dataclass(frozen=True)
class Suite:
    """Every controller runs every (scenario, seed) pair, so that all comparisons are paired.

    Attributes:
        name: what results are filed under.
        controllers: names for `agents.make_controller`.
        scenarios: names for `swarm_gym.scenarios.make_scenario`.
        num_seeds: seeds per scenario, none of which training or validation ever uses.
        baseline: the controller, or key of the group, that the others are compared with.
        snapshots: (controller, scenario, seed, iterations) of runs whose populations are kept.
        optimizer: name of the optimizer.
        first_seed: the first seed of the first scenario.
        seed_step: how far the seeds of a scenario start after those of the one before it; 0: the same.
        families: controllers whose fronts are measured.
        reference: evaluations and gap that hypervolumes are measured from; what is worse counts for nothing.
        tables: names in `experiments.tables.TABLES`.
        figures: names in `experiments.figures.FIGURES`.
    """

    name: str
    controllers: tuple[str, ...]
    scenarios: tuple[str, ...]
    num_seeds: int
    baseline: str
    snapshots: tuple[tuple[str, str, int, tuple[int, ...]], ...] = ()
    optimizer: str = "firefly"
    first_seed: int = 0
    seed_step: int = 0
    families: tuple[Family, ...] = ()
    reference: tuple[float, float] = (1_000_000.0, 0.2)
    tables: tuple[str, ...] = PAPER_TABLES
    figures: tuple[str, ...] = PAPER_FIGURES

    @cached_property
    def seeds(self) -> dict[str, range]:
        """The seeds of every scenario, by its name."""
        firsts = [self.first_seed + k * self.seed_step for k in range(len(self.scenarios))]
        return {
            name: range(first, first + self.num_seeds)
            for name, first in zip(self.scenarios, firsts, strict=True)
        }


def training_seeds(recipe: str, number: int) -> tuple[str, ...]:
    """Names of the policies of one recipe: `ppo:three-cases/0` and so on."""
    return tuple(f"{recipe}/{k}" for k in range(number))


CASES = ("case1", "case2", "case3")
FIXED_SIZES = Family("fixed sizes", ("fixed:60", "fixed:100"))
SCHEDULES = Family("schedules", ("spsfa", "spsfa-tip"))
STUDIED = ("fixed:60", "fixed:100", "spsfa", "spsfa-tip", "random", "ppo:three-cases")

PAPER = Suite(
    name="paper",
    controllers=(
        "fixed:60",
        "fixed:80",
        "fixed:100",
        "spsfa",
        "spsfa-tip",
        "random",
        "ppo:three-cases",
    ),
    scenarios=CASES,
    num_seeds=20,
    baseline="spsfa-tip",
    snapshots=(("spsfa-tip", "case1", 0, (0, 3, 10, 30, 60, 100)),),
)

PARAMETERS = Suite(
    name="parameters",
    controllers=parameter_study.CONTROLLERS,
    scenarios=(parameter_study.SCENARIO,),
    num_seeds=20,
    baseline="spsfa-tip",
    tables=("parameters",),
    figures=("parameters",),
)

HEADLINE = Suite(
    name="headline",
    controllers=STUDIED,
    scenarios=CASES,
    num_seeds=200,
    baseline="spsfa-tip",
    first_seed=FRESH_SEEDS,
    families=(FIXED_SIZES, SCHEDULES),
    tables=STUDY_TABLES,
    figures=STUDY_FIGURES,
)

ABLATION = Suite(
    name="ablation",
    controllers=STUDIED,
    scenarios=CASES,
    num_seeds=100,
    baseline="spsfa-tip",
    first_seed=FRESH_SEEDS,
    families=(FIXED_SIZES, SCHEDULES),
    tables=STUDY_TABLES,
    figures=STUDY_FIGURES,
)

GENERALISATION = Suite(
    name="generalisation",
    controllers=STUDIED,
    scenarios=numbered("random-fields:test", 200),
    num_seeds=1,
    baseline="spsfa-tip",
    first_seed=FRESH_SEEDS,
    seed_step=1,
    families=(FIXED_SIZES, SCHEDULES),
    tables=STUDY_TABLES,
    figures=STUDY_FIGURES,
)

# Kinds of fields that no policy is trained on.
UNSEEN_KINDS = ("denser", "longer", "larger", "polygons", "grid-maps")

OUT_OF_DISTRIBUTION = Suite(
    name="out-of-distribution",
    controllers=STUDIED,
    scenarios=tuple(name for kind in UNSEEN_KINDS for name in numbered(f"random-fields:{kind}", 40)),
    num_seeds=1,
    baseline="spsfa-tip",
    first_seed=FRESH_SEEDS,
    seed_step=1,
    families=(FIXED_SIZES, SCHEDULES),
    tables=STUDY_TABLES,
    figures=STUDY_FIGURES,
)

SUITES = {
    suite.name: suite
    for suite in (PAPER, PARAMETERS, HEADLINE, ABLATION, GENERALISATION, OUT_OF_DISTRIBUTION)
}


def get_suite(name: str) -> Suite:
    """The suite of that name.

    Raises:
        UnknownNameError: if there is none.
    """
    return look_up("suite", name, SUITES)

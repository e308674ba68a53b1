"""The BBOB functions as MetaBox has them, by the names `metabox-bbob:<function>-<dimension>`.

MetaBox compares learned optimizers on these functions. Source: the program of Z. Ma et al., "MetaBox-v2: a
unified benchmark platform for meta-black-box optimization", NeurIPS 2025; `bbob.metabox_instance` draws the
instances. The functions are BBOB's, but for two things: the functions 2, 3 and 4 are of a rotated
vector, and instances are drawn in another way.

`metabox-bbob:4-10` is function 4 in ten dimensions, from the seed 3849. `metabox-bbob:4-10-seed:7` is drawn
from another seed. `metabox-bbob:4-10-biased` has a least value f_opt, as data sets of MetaBox have by
default; its optimum and its rotations are other ones, too. `metabox-bbob:train` and `metabox-bbob:test` stand
for the 8 functions for training and the 16 for tests of MetaBox's mode `difficult`, in ten dimensions.
"""

import re
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

from swarm_gym.errors import ScenarioError, shown
from swarm_gym.scenarios.bbob.instance import (
    ELLIPSOID,
    RASTRIGIN,
    ROTATED_ELLIPSOID,
    SKEW_RASTRIGIN,
    TURNED_RASTRIGIN,
    TURNED_SKEW_RASTRIGIN,
)
from swarm_gym.scenarios.bbob.metabox_instance import SEED, MetaBoxInstance
from swarm_gym.scenarios.bbob.scenario import FUNCTIONS, BbobScenario, BbobSuite, require_parts
from swarm_gym.scenarios.family import NUMBER, Family, parse_numbers

NAME = "metabox-bbob"
METABOX = BbobSuite("MetaBox", NAME, (10, 30), range(1, 1_000_000_000), "seed")
TRAIN = (1, 2, 3, 5, 15, 16, 17, 21)
SETS = {"train": TRAIN, "test": tuple(number for number in FUNCTIONS if number not in TRAIN)}
USAGE = f"{NAME}:<function>-<dimension>[-biased][-seed:<seed>], {NAME}:train or {NAME}:test"

ROTATED = {ELLIPSOID: ROTATED_ELLIPSOID, RASTRIGIN: TURNED_RASTRIGIN, SKEW_RASTRIGIN: TURNED_SKEW_RASTRIGIN}


@dataclass(frozen=True)
class MetaBoxScenario(BbobScenario):
    """The task to find the minimum of a BBOB function as MetaBox has it; f_opt is subtracted.

    Attributes:
        name: name under which results are filed.
        function: `metabox-bbob-1` to `metabox-bbob-24`.
        dimension: D, the length of a decision vector, 10 or 30.
        optimum: (D,) x_opt, the position of the minimum; it follows from the others.
        instance: seed of the instance, by default the seed of MetaBox's own data set.
        biased: whether f_opt is drawn, as in data sets of MetaBox by default; else it is 0.

    Raises:
        ScenarioError: for a function, a dimension or a seed that MetaBox does not have.
    """

    suite: ClassVar[BbobSuite] = METABOX
    instance: int = SEED
    biased: bool = False

    @cached_property
    def drawn(self) -> MetaBoxInstance:
        """The instance: optimum, rotations, peaks and f_opt."""
        return MetaBoxInstance(self.number, self.dimension, self.instance, self.biased)

    @property
    def form(self) -> int:
        """Number of the formula by which problems compute the values."""
        return ROTATED.get(self.number, self.number)

    @property
    def identity(self) -> tuple[object, ...]:
        """The suite, the numbers of function, dimension and seed, and whether f_opt is drawn."""
        return *super().identity, self.biased


def expand(name: str) -> tuple[str, ...]:
    """Return the names of the single functions that a name stands for.

    `metabox-bbob:test-30` stands for sixteen functions, and `metabox-bbob:4-10-seed:1-50` for fifty seeds.

    Raises:
        ScenarioError: if the name has another form, or MetaBox has no such function.
    """
    functions, dimension, biased, seeds = _parse(name)
    return tuple(
        f"{NAME}:{function}-{dimension}{'-biased' * biased}" + (f"-seed:{seed}" if seed != SEED else "")
        for function in functions
        for seed in seeds
    )


def make(name: str) -> MetaBoxScenario:
    """Return the single function of that name."""
    functions, dimension, biased, seeds = _parse(name)
    return MetaBoxScenario(name, f"{NAME}-{functions[0]}", dimension, seeds[0], biased)


def tidy(name: str) -> str:
    """Return the one form of a name: without the seed that it has by default."""
    return re.sub(rf"(?<=[0-9d])-seed:{SEED}$", "", name)


def _parse(name: str) -> tuple[tuple[int, ...], int, bool, range]:
    """Return the functions, the dimension, whether f_opt is drawn, and the seeds."""
    pattern = rf"{NAME}:(?:({NUMBER})-({NUMBER})|(train|test)(?:-({NUMBER}))?)(-biased)?(?:-seed:(.+))?"
    match = re.fullmatch(pattern, name)
    seeds = parse_numbers(match[6] or str(SEED), name) if match else range(0)
    if match is None or not seeds:
        raise ScenarioError(
            f"scenario {shown(name)}: expected {USAGE}, such as {NAME}:4-10, {NAME}:4-10-seed:1-50 or "
            f"{NAME}:test-30-biased"
        )
    functions = SETS[match[3]] if match[3] else (int(match[1]),)
    dimension = int(match[2] or match[4] or METABOX.dimensions[0])
    for seed in (seeds[0], seeds[-1]):
        require_parts(f"scenario {shown(name)}", functions[0], dimension, seed, METABOX)
    return functions, dimension, match[5] is not None, seeds


FAMILY = Family(USAGE, (), expand, make, tidy)

"""Names of controllers, taken apart and put together; no other module does either.

A name is `[<optimizer>[(<iterations>)]+]<family>[:<argument>]`. The argument of a family in `FITTED` is a
recipe or a file, `<recipe>[/<seed>][@<price>]`; any other family has its parameters there.

* `spsfa-tip`: a family alone, with its default parameters.
* `fixed:60`, `spsfa-tip:growth=500,decay=0.1`: a family with parameters.
* `learned:three-cases/0`: the policy of the recipe `three-cases` with training seed 0.
* `learned:three-cases/*`: all training seeds of that recipe, as a group.
* `learned:three-cases/0@0.3`: that policy for the price 0.3.
* `together:cma-search-restarts`: the policies of all training seeds of that recipe, whose mean decides.
* `open-loop:three-cases-extended@2`: the open loop of the recipe `three-cases-extended` for the price 2.
* `reacting-loop:dynamic-reacting/0@1`: the open loop of that name, begun again when the best fitness rises.
* `tuned:runs/mine.json`: a file.
* `blinded:three-cases/0@0.3`: in a suite, that policy with all inputs but the clock replaced by their means.
* `mine:Rule`: own code, see `swarm_gym.own_code`.
* `mine:Swarm+fixed:65`: in a suite, `fixed:65` for an optimizer of own code.
* `multivariate(50)+fixed:65`: in a suite, `fixed:65` for this optimizer, in episodes of 50 iterations.

The character @ always introduces the price of 100,000 evaluations that the controller is for. An open loop
was tuned at that price, and its file is stored under the whole argument. A policy that observes the price
serves a range of them, and decides for the one in its name.
"""

import re
from dataclasses import dataclass, replace
from typing import Self

BLINDED = "blinded"
# Their arguments are recipes or files.
FITTED = (BLINDED, "distilled", "learned", "open-loop", "reacting-loop", "tuned")
ALL_SEEDS = "*"

_NAME = re.compile(
    rf"(?:(?P<optimizer>[a-z-]+|(?!(?:{'|'.join(FITTED)}):)[A-Za-z_][\w.]*:[A-Za-z_]\w*)"
    r"(?:\((?P<iterations>[1-9][0-9]{0,8})\))?\+)?"
    r"(?P<family>[^:]*)(?::(?P<argument>.*))?",
    re.DOTALL,
)
_FITTED_ARGUMENT = re.compile(
    r"(?P<recipe>.*?)(?:(?<=.)/(?P<seed>0|[1-9][0-9]{0,8}|\*))?(?:@(?P<price>[^@/]*))?", re.DOTALL
)


@dataclass(frozen=True)
class ControllerName:
    """The parts of a controller's name; `str` puts them together again.

    Attributes:
        family: key in `swarm_gym.controllers.CONTROLLERS`, if the name is valid.
        recipe: name of a packaged file, or path, without seed and price; families in `FITTED` only.
        seed: training seed, or `ALL_SEEDS` for the whole group; families in `FITTED` only.
        price: price of 100,000 evaluations, as it is written; families in `FITTED` only.
        parameters: text after the colon, for all other families; None without a colon.
        optimizer: optimizer that a suite's entrant is for; None is the suite's own.
        iterations: length of an entrant's episodes; None is the suite's own.
    """

    family: str
    recipe: str | None = None
    seed: int | str | None = None
    price: str | None = None
    parameters: str | None = None
    optimizer: str | None = None
    iterations: int | None = None

    @classmethod
    def parse(cls, name: str) -> Self:
        """Return the parts of any text; whether they are valid is checked where a controller is made."""
        match = _NAME.fullmatch(name)
        assert match is not None  # the pattern matches every text
        parts = cls.of(match["family"], match["argument"])
        iterations = None if match["iterations"] is None else int(match["iterations"])
        return replace(parts, optimizer=match["optimizer"], iterations=iterations)

    @classmethod
    def of(cls, family: str, argument: str | None) -> Self:
        """Return the name of a family with what follows the colon; None is no colon."""
        if argument is None or family not in FITTED:
            return cls(family, parameters=argument)
        match = _FITTED_ARGUMENT.fullmatch(argument)
        assert match is not None
        seed = match["seed"]
        number = seed if seed is None or seed == ALL_SEEDS else int(seed)
        return cls(family, match["recipe"], number, match["price"])

    @property
    def argument(self) -> str:
        """Text after the colon; the empty string without one."""
        if self.recipe is None:
            return self.parameters or ""
        seed = "" if self.seed is None else f"/{self.seed}"
        return f"{self.recipe}{seed}{self.price_suffix}"

    @property
    def price_suffix(self) -> str:
        """The price with its @, or the empty string."""
        return "" if self.price is None else f"@{self.price}"

    @property
    def without_price(self) -> Self:
        """The name without its price."""
        return replace(self, price=None)

    @property
    def controller(self) -> Self:
        """The name that `make_controller` takes: without the optimizer and iterations of an entrant."""
        return replace(self, optimizer=None, iterations=None)

    @property
    def group(self) -> Self:
        """The name of all training seeds of its recipe; other controllers keep their own."""
        return self if self.seed is None else replace(self, seed=ALL_SEEDS)

    @property
    def group_key(self) -> str:
        """Name under which the training seeds of one recipe are pooled; other controllers keep their own."""
        return str(self.group)

    def __str__(self) -> str:
        iterations = "" if self.iterations is None else f"({self.iterations})"
        entrant = "" if self.optimizer is None else f"{self.optimizer}{iterations}+"
        colon = "" if self.recipe is None and self.parameters is None else ":"
        return f"{entrant}{self.family}{colon}{self.argument}"

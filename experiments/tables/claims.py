"""Claims of a document about results: how often each of them holds, and where it does not."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from experiments.tables.cell import MISSING, Entry, count_of
from experiments.tables.table import Table


@dataclass(frozen=True)
class Claim:
    """A claim, and whether it holds in each of the cases that it is about.

    Attributes:
        text: the claim in words.
        cases: whether it holds, by the name of the case.
    """

    text: str
    cases: Mapping[str, bool]

    @property
    def row(self) -> tuple[Entry, ...]:
        """Claim, number of cases in which it holds, and names of the other cases."""
        failing = [case for case, holds in self.cases.items() if not holds]
        holding = len(self.cases) - len(failing)
        return self.text, count_of(holding, len(self.cases)), ", ".join(failing) or MISSING


def claims_table(name: str, caption: str, claims: Sequence[Claim]) -> Table:
    """Return a table of the claims that are about at least one case, in their order."""
    columns = ("claim", "holds", "does not hold")
    return Table(name, caption, columns, [claim.row for claim in claims if claim.cases])

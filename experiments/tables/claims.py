"""What a document says of results, each claim with how often it holds and where it does not."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from experiments.tables.table import Table


@dataclass(frozen=True)
class Claim:
    """A claim, and whether it holds in each of the cases that it is about."""

    text: str
    cases: Mapping[str, bool]

    @property
    def row(self) -> tuple[str, str, str]:
        """Claim, how many of its cases hold, and the others."""
        failing = [case for case, holds in self.cases.items() if not holds]
        return self.text, f"{len(self.cases) - len(failing)} of {len(self.cases)}", ", ".join(failing) or "–"


def claims_table(name: str, caption: str, claims: Sequence[Claim]) -> Table:
    """The claims that are about anything, in their order."""
    return Table(
        name, caption, ("claim", "holds", "does not hold"), [claim.row for claim in claims if claim.cases]
    )


def yes(holds: bool) -> str:
    """Whether something holds; what does not is bold."""
    return "yes" if holds else "**no**"

"""Comparative sentences of a study, read from its file `claims.toml`.

An entry of the file:

    [[claim]]
    sentence = "PPO ends closer to the optimum than SPSFA-TIP."
    suite = "headline"
    group = "learned:three-cases/*@1"
    rival = "spsfa-tip"

A sentence may be about several subjects, each of which has a group of its own:

    [[claim]]
    sentence = "PPO has a smaller objective than the rules as printed."
    about = ["fish-swarm", "particle-swarm"]
    suite = "optimizers"
    group = "{about}+learned:optimizers-{about}/*@1"
    rival = "{about}+spsfa-tip"

`experiments.tables.claim_tables` checks them against stored runs.
"""

import dataclasses
import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from experiments.runs.measures import MEASURES
from swarm_gym.errors import shown


class ClaimFileError(ValueError):
    """A file of claims that has an invalid entry; the message names the file and the entry."""


@dataclass(frozen=True)
class GroupClaim:
    """A sentence about a group of controllers: one of its measures is below that of a rival, or a limit.

    Attributes:
        sentence: the sentence.
        suite: name of the suite whose runs decide. In a file, a list of names stands for a claim of each.
        group: key of the group that the sentence is about.
        rival: key of the group that it is compared with, on the same scenarios and seeds, or a yardstick of
            the suite; empty if the sentence has a limit.
        metric: name of a measure in `experiments.runs.measures`, averaged over runs.
        factor: the group has to be below this multiple of the rival.
        limit: number that the group has to be below, if there is no rival.
        price: price of 100,000 evaluations in the objective.
        sets: sets of scenarios, or single scenarios, that the sentence is about; by default all sets, and
            their union.
        about: subject of the sentence, where it is said of several; empty otherwise. In a file, a list of
            subjects stands for a claim of each, and `{about}` in group and rival for the subject.
    """

    sentence: str
    suite: str
    group: str
    rival: str = ""
    metric: str = "gap"
    factor: float = 1.0
    limit: float = 0.0
    price: float = 1.0
    sets: tuple[str, ...] = ()
    about: str = ""

    def __post_init__(self) -> None:
        if self.metric not in MEASURES:
            raise ValueError(f"metric must be one of {', '.join(MEASURES)}, got {shown(self.metric)}")
        if bool(self.rival) == (self.limit > 0.0):
            raise ValueError("a claim needs either a rival or a limit above 0")


def load_claims(path: Path) -> tuple[GroupClaim, ...]:
    """Return the claims in a file, in their order.

    Raises:
        ClaimFileError: for a file that is no TOML, an unknown key, or a value that a claim cannot have.
    """
    try:
        content = tomllib.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise ClaimFileError(f"{path}: not a readable file of claims ({error})") from error
    if set(content) - {"claim"}:
        raise ClaimFileError(f"{path}: expected tables [[claim]] only, got {', '.join(content)}")
    return tuple(
        claim
        for k, entry in enumerate(content.get("claim", []))
        for claim in _read(entry, f"{path}: claim {k + 1}")
    )


def _read(entry: dict[str, Any], where: str) -> list[GroupClaim]:
    known = [one.name for one in dataclasses.fields(GroupClaim)]
    if unknown := sorted(set(entry) - set(known)):
        raise ClaimFileError(f"{where}: unknown key {shown(unknown[0])}, expected some of {', '.join(known)}")
    values = {**entry, **({"sets": tuple(entry["sets"])} if "sets" in entry else {})}
    named = values.pop("suite", [])
    suites = [named] if isinstance(named, str) else named
    subjects = values.pop("about", [""])
    if not (isinstance(subjects, list) and all(isinstance(subject, str) for subject in subjects)):
        raise ClaimFileError(f"{where}: about has to be a list of subjects, got {shown(subjects)}")
    if not suites:
        raise ClaimFileError(f"{where}: suite is missing, a name or a list of names")
    try:
        return [
            GroupClaim(**_for_subject(values, subject), suite=suite)
            for suite in suites
            for subject in subjects
        ]
    except (TypeError, ValueError) as error:
        raise ClaimFileError(f"{where}: {error}") from error


def _for_subject(values: dict[str, Any], subject: str) -> dict[str, Any]:
    """Return the values of a claim with the subject in place of `{about}` in the names of groups."""
    named: dict[str, Any] = {
        key: values[key].replace("{about}", subject) for key in ("group", "rival") if key in values
    }
    return {**values, **named, "about": subject}

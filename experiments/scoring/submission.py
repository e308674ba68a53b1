"""Submissions: policies, and controllers that ship, with the digests that tell them apart.

Everything that can be wrong with a submission itself is refused here, before anything runs.
"""

import hashlib
import json
import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from agents import CONTROLLERS
from experiments.runs.configuration import identity
from experiments.runs.episode import controller_of
from experiments.scoring.suites import LEARNED, PRICE, ScoredSuite
from swarm_gym.comparing.entrants import entrant
from swarm_gym.controllers.learned.policy_file import (
    MAX_FILE,
    PolicyFileError,
    decode_policy,
    resolve,
)
from swarm_gym.controllers.names import FITTED, ControllerName
from swarm_gym.controllers.packaged import read_bytes
from swarm_gym.errors import shown

# Entries of a manifest that the table of training options below it states, too.
STATED_TWICE = (
    "action", "also_on", "base", "corrected_from", "hidden_layers", "lstm_size", "max_evaluations",
    "max_population_size", "min_population_size", "observation", "optimizer", "price",
)  # fmt: skip


class SubmissionError(ValueError):
    """A submission that is refused; the message names the file, what is wrong and what was expected."""


@dataclass(frozen=True)
class Submission:
    """A controller that a suite can score.

    Attributes:
        name: name or path, as it was given.
        digest: SHA-256 of the policy's file, or of the data of another controller.
        entrants: names of the entrants, one for each optimizer that it is scored on.
        is_policy: whether it is a policy, which rows of scores may call by another name.
    """

    name: str
    digest: str
    entrants: tuple[str, ...]
    is_policy: bool

    @property
    def digests(self) -> dict[str, str]:
        """Digests by names of the entrants, all of which are the same controller."""
        return dict.fromkeys(self.entrants, self.digest)


def read_submission(name: str, scored: ScoredSuite) -> Submission:
    """Return the submission of a name, checked for a suite.

    Args:
        name: path of a policy file, name of a packaged policy such as `learned:three-cases/0@1`, or entrant
            of the suite that is no policy.
        scored: suite that shall score it.

    Raises:
        PolicyFileError: if the file is missing or damaged, or if its manifest does not fit its arrays.
        SubmissionError: if the manifest contradicts itself, or is for another optimizer, price or seeds.
    """
    if name in scored.references:
        return Submission(name, digest_of_data(name, scored), (name,), is_policy=False)
    policy, path = find_policy(name)
    data = _content(path)
    _, manifest = decode_policy(path, data)
    refuse_contradictions(path, manifest)
    if not scored.fitting(manifest):
        raise SubmissionError(
            f"{path}: the manifest states the optimizer {manifest['optimizer']}, but the suite {scored.name} "
            f"is of {', '.join(scored.optimizers)}"
        )
    _refuse_seen_seeds(path, manifest, scored)
    entrants = scored.entrants_of(policy, manifest)
    _refuse_other_price(name, entrants)
    for one in entrants:
        controller_of(entrant(one, scored.experiment.optimizer).controller)  # or it raises PolicyFileError
    return Submission(name, hashlib.sha256(data).hexdigest(), tuple(entrants), is_policy=True)


def digest_of(name: str, scored: ScoredSuite) -> str:
    """Return the digest of an entrant that ships: of its file if it is a policy, else of its data."""
    parts = ControllerName.parse(entrant(name, scored.experiment.optimizer).controller)
    if parts.family != LEARNED:
        return digest_of_data(name, scored)
    return digest_of_policy(str(parts))


def digest_of_policy(name: str) -> str:
    """Return the SHA-256 of the file of a policy, by its path or the name of a packaged one.

    Raises:
        PolicyFileError: if there is no such file.
    """
    return hashlib.sha256(_content(find_policy(name)[1])).hexdigest()


def digest_of_data(name: str, scored: ScoredSuite) -> str:
    """Return the SHA-256 of what a controller is, as JSON with sorted keys: its decisions, or its name."""
    controller = entrant(name, scored.experiment.optimizer).controller
    content = json.dumps(identity(controller, controller_of(controller)), sort_keys=True)
    return hashlib.sha256(content.encode()).hexdigest()


def find_policy(name: str) -> tuple[str, Path]:
    """Return the name behind `learned:` of a policy without its price, and its file.

    Raises:
        PolicyFileError: if there is no such file or packaged policy.
    """
    if os.path.isfile(name):
        return name, Path(name)
    parts = ControllerName.parse(name)
    if parts.family != LEARNED:
        if parts.family in CONTROLLERS:
            raise PolicyFileError(f"{shown(name)}: no policy, and no controller of the suite")
        raise PolicyFileError(
            f"{shown(name)}: no such file; expected a policy file, or a packaged policy such as "
            f"{LEARNED}:three-cases/0"
        )
    policy = parts.without_price.argument
    return policy, resolve(policy)


def refuse_contradictions(path: Path, manifest: Mapping[str, Any]) -> None:
    """Raise an error if entries of a manifest contradict each other, or name a file that did not come along.

    Raises:
        SubmissionError: naming the entries.
    """
    config = manifest["config"]
    for key in STATED_TWICE:
        top, below = manifest.get(key), config.get(key)
        # No budget is null in the manifest and 0 among the options; `also_on` may be left out.
        if key in config and (top or None) != (below or None):
            raise SubmissionError(
                f"{path}: the manifest contradicts itself: {key} is {shown(top)}, but config.{key} is "
                f"{shown(below)}"
            )
    base = ControllerName.parse(manifest["base"])
    if base.family in FITTED and os.path.isfile(base.argument):
        raise SubmissionError(
            f"{path}: base {shown(manifest['base'])} is a file; a score needs a base that ships, since the "
            "digest of the policy does not cover another file"
        )


def _content(path: Path) -> bytes:
    try:
        return read_bytes(path, MAX_FILE)
    except (OSError, ValueError) as error:
        raise PolicyFileError(f"{path}: not a readable policy file ({error})") from error


def _refuse_seen_seeds(path: Path, manifest: Mapping[str, Any], scored: ScoredSuite) -> None:
    """Raise an error if a policy was chosen with seeds that the suite scores it on."""
    stated = manifest.get("validation_seeds")
    if not (isinstance(stated, list) and len(stated) == 2 and all(type(seed) is int for seed in stated)):
        return
    seen = range(*stated)
    used = {seed for chosen in scored.sets.values() for _, seed in chosen.runs}
    if any(seed in seen for seed in used):
        raise SubmissionError(
            f"{path}: the manifest states validation with seeds {stated[0]} to {stated[1] - 1}, among which "
            f"are seeds of the suite {scored.name}, {min(used)} to {max(used)}"
        )


def _refuse_other_price(name: str, entrants: list[str]) -> None:
    given = None if os.path.isfile(name) else ControllerName.parse(name).price
    told = {ControllerName.parse(one).price for one in entrants}
    if given is not None and {given} != told:
        wanted = f"@{PRICE:g}" if told != {None} else "none, since the policy does not observe it"
        raise SubmissionError(f"{name}: expected the price {wanted}, got @{given}")

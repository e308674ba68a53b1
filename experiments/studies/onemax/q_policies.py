"""Policies of double DQN for lambda, which `double_dqn` trains: their file, and what they are worth."""

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TypedDict

import numpy as np

from experiments.studies.onemax.runtimes import Floats, expected_of_sizes
from swarm_gym.reference.onemax.optima import PORTFOLIO

FILE = Path(__file__).parent / "data" / "double_dqn.json"
CHOICES = np.array(PORTFOLIO, dtype=np.float64)


class Policy(TypedDict):
    """A trained policy of lambda for one length, as the file has it.

    Attributes:
        seed: training seed.
        step: step at which the policy was the best so far.
        best: exponents of lambda of that policy, from n / 2 ones to n - 1.
        last: exponents of lambda of the policy at the end of the training.
    """

    seed: int
    step: int
    best: list[int]
    last: list[int]


class Trained(TypedDict):
    """The trainings for one length, as the file has them.

    Attributes:
        policies: a policy of each training seed.
        provenance: versions that they were made with.
    """

    policies: list[Policy]
    provenance: Mapping[str, object]


def expected_of(policy: Sequence[int], size: int) -> float:
    """Return the expected evaluations of a policy from n / 2 ones on, the first string included.

    Args:
        policy: exponents of lambda, from n / 2 ones to n - 1.
        size: n, the length of the string.
    """
    exponents = np.concatenate([np.full(size - len(policy), policy[0]), policy])
    return expected_of_sizes(CHOICES[exponents])


def expected_of_trained(size: int, at_the_end: bool = False) -> Floats:
    """Return the (S,) expected evaluations of the policies of a length that ship; none is an empty array.

    Args:
        size: n, the length of the string.
        at_the_end: take the policies at the end of their trainings, not the best ones.
    """
    trained = stored()
    policies = trained[str(size)]["policies"] if str(size) in trained else []
    return np.array(
        [expected_of(policy["last"] if at_the_end else policy["best"], size) for policy in policies]
    )


def stored(file: Path = FILE) -> dict[str, Trained]:
    """Return what is stored of all lengths."""
    found: dict[str, Trained] = json.loads(file.read_text(encoding="utf-8")) if file.exists() else {}
    return found

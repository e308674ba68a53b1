"""Digests of what decides runs today: controllers by their groups, and what optimizers compute.

A golden file of the tests has what an optimizer computes; it changes exactly where results change.
"""

import hashlib
import json
from collections.abc import Iterable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from experiments.documents.records import git
from experiments.runs.configuration import identities, optimizers_of
from experiments.runs.experiment import Experiment
from experiments.runs.groups import group_controllers
from experiments.studies.controllers import packaged_seeds
from experiments.studies.onemax import q_policies
from experiments.studies.onemax.tables import FOUR, RECIPES
from experiments.studies.strong.entrants import controller_of, entrants
from swarm_gym.controllers import make_controller
from swarm_gym.controllers.names import BLINDED, ControllerName

DIGITS = 12
ROOT = Path(__file__).parents[2]
RESULTS_OF = "results of "  # before the name of an optimizer, in records
SEVERAL = "several"  # in place of a digest, if the runs were made with several of them


def digest(content: Any) -> str:
    """Return the first digits of the SHA-256 of what JSON can hold."""
    return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()[:DIGITS]


def results_key(optimizer: str) -> str:
    """Return the name under which a record has what an optimizer computes."""
    return f"{RESULTS_OF}{optimizer}"


def digests_of_results(optimizers: Iterable[str], commits: Iterable[str] = ()) -> dict[str, str]:
    """Return digests of what optimizers compute, by `results_key`; those without a golden file are left out.

    Args:
        optimizers: names of the optimizers.
        commits: commits whose files count, by default the files of the checkout. If a commit is unknown or
            stands for changed files, nothing is returned.
    """
    found = {}
    for optimizer in sorted(set(optimizers)):
        file = f"tests/golden/{optimizer}.json"
        contents = {git("show", f"{commit}:{file}") for commit in commits} or {_read(ROOT / file)}
        if "" not in contents:
            digests = {digest(json.loads(content)["courses"]) for content in contents}
            found[results_key(optimizer)] = digests.pop() if len(digests) == 1 else SEVERAL
    return found


def digests_of_groups(experiment: Experiment, identity: Mapping[str, Any]) -> dict[str, str]:
    """Return digests of the groups of controllers of an experiment, by their keys.

    Args:
        experiment: the experiment.
        identity: identities of controllers by name. A group of which one is missing is left out.
    """
    groups = group_controllers(experiment.controllers)
    return {
        key: digest([[name, identity[name]] for name in members])
        for key, members in groups.items()
        if identity.keys() >= set(members)
    }


def digests_today(experiment: Experiment) -> dict[str, str]:
    """Return the digests of what decides the runs of an experiment today."""
    part = seeing(experiment)
    return digests_of_groups(part, identities(part)) | digests_of_results(optimizers_of(part))


def seeing(experiment: Experiment) -> Experiment:
    """Return an experiment without blinded policies, each of which follows from a policy and runs of it."""
    chosen = [name for name in experiment.controllers if ControllerName.parse(name).family != BLINDED]
    return replace(experiment, controllers=tuple(chosen))


def _read(file: Path) -> str:
    return file.read_text(encoding="utf-8") if file.is_file() else ""


def digests_of_rivals() -> dict[str, str]:
    """Return the digests of the controllers beside plain learners, by the rows of their table."""
    # Imported here: the recipes of learners need torch.
    from experiments.studies.learners.tables_of_learners import RIVALS

    controllers = {row: [make_controller(name).identity() for name in names] for row, names in RIVALS.items()}
    return {row: digest(identity) for row, identity in controllers.items()} | digests_of_results(["firefly"])


def digests_of_strong() -> dict[str, str]:
    """Return the digests of the rows of the study of strong optimizers, by the names of rows."""
    found = {}
    for one in entrants():
        identity = [controller_of(one, name).identity() for name in one.controllers]
        found[one.name] = digest([one.optimizer, one.iterations, identity])
    return found | digests_of_results(one.optimizer for one in entrants())


def digests_of_terrain(names: Iterable[str] | None = None) -> dict[str, str]:
    """Return the digests of the swarms over terrain by the names of their rows, and those of results.

    The digest of a row is taken over the row, its size or controllers, and the results of the optimizer.

    Args:
        names: names of rows; by default all. Rows of other libraries have no digest, and are passed over.
    """
    # Imported here: rows of other libraries need these.
    from experiments.studies.terrain.controllers_of_terrain import EVALUATIONS, controller_of, rows
    from experiments.studies.terrain.rows import SIZES, ControlledRow, Row

    swarms = [row for row in rows() if isinstance(row, Row | ControlledRow)]
    if names is not None:
        chosen = set(names)
        swarms = [row for row in swarms if row.name in chosen]
    results = digests_of_results(row.optimizer for row in swarms)
    found = {}
    for row in swarms:
        if isinstance(row, Row):
            described: list[object] = [*row]
            deciding: object = SIZES[row.optimizer]
        else:
            budget = row.iterations, row.evaluations  # `longer` decides which runs there are, and no result
            described = [row.label, row.optimizer, row.source, row.controllers, *budget]
            described += [row.encoding] if row.encoding != "waypoints" else []
            # A blinded policy follows from a policy, which has a row, and runs of it.
            plain = [name for name in row.controllers if ControllerName.parse(name).family != BLINDED]
            deciding = [controller_of(row, name, EVALUATIONS).identity() for name in plain]
        found[row.name] = digest([described, deciding, results[results_key(row.optimizer)]])
    return found | results


def digests_of_one_max() -> dict[str, str]:
    """Return the digests of the policies and schedules of the study of OneMax, by recipe or name."""
    recipes = {recipe: packaged_seeds(recipe) for recipe in (*RECIPES.values(), FOUR)}
    names = {**recipes, **{name: (name,) for name in ("share:lambda", "share:four", "one-fifth")}}
    found = {
        key: digest([make_controller(name).identity() for name in members]) for key, members in names.items()
    }
    trained = {size: one["policies"] for size, one in q_policies.stored().items()}
    return found | {"double DQN": digest(trained)} | digests_of_results(["one-plus-lambda-lambda"])

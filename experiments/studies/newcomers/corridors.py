"""Corridors of final best paths: how many runs end in which, and how good the best path in each is.

Whether two paths are in one corridor is told by `swarm_gym.corridors`. On each scenario, A is the corridor of
the optimum. The letters after it name the corridors in which most of the other runs end. They are ordered by
the fitness of the best path that was found in them. All remaining corridors are pooled.
"""

from dataclasses import dataclass
from string import ascii_uppercase

import numpy as np

from experiments.runs.labels import label
from experiments.runs.outcomes import Floats, Outcomes
from experiments.runs.run import Run
from experiments.runs.suite import Suite
from experiments.tables.cell import MISSING, number, share, share_in
from experiments.tables.table import Row, Table
from swarm_gym.corridors import Corridors, signatures
from swarm_gym.problem import AnalyticProblem
from swarm_gym.reference import known_optimum
from swarm_gym.reference.waypoint_optimum import optimum
from swarm_gym.worlds import make_problem

MOST_NAMED = 5  # corridors of a scenario that have letters
OPTIMAL, OTHERS = "A", "others"

Signature = tuple[int, ...]


@dataclass(frozen=True)
class Corridor:
    """A corridor of a scenario with the runs that ended in it.

    Attributes:
        name: letter of the corridor.
        signature: signature of its paths.
        runs: runs whose final best path is in it, of all controllers.
        path: the best of these paths, (k, 2) in map coordinates; the optimal path if no run ended in A.
        fitness: fitness of that path.
    """

    name: str
    signature: Signature
    runs: tuple[Run, ...]
    path: Floats
    fitness: float


@dataclass(frozen=True)
class Ends:
    """The corridors of a scenario in which runs end.

    Attributes:
        scenario: name of the scenario.
        optimum: least fitness.
        corridors: corridors with letters, A first.
        names: (seeds,) by controller: letters of the corridors of its runs, or `OTHERS`.
        pooled: number of corridors without a letter.
    """

    scenario: str
    optimum: float
    corridors: tuple[Corridor, ...]
    names: dict[str, list[str]]
    pooled: int

    def shares(self, controllers: tuple[str, ...], name: str) -> Floats:
        """Return 1 where a run ended in a corridor, else 0; (controllers, 1, seeds)."""
        found = [[float(ended == name) for ended in self.names[controller]] for controller in controllers]
        return np.array(found)[:, None]


def ends_of(scenario: str, outcomes: Outcomes) -> Ends:
    """Return the corridors in which the runs on a scenario end.

    Raises:
        SettingError: if decision vectors are not whole paths on a map.
    """
    problem = make_problem(scenario)
    assert isinstance(problem, AnalyticProblem)
    known = Corridors.of(problem)
    _, vector = optimum(problem)
    least = known_optimum(problem)
    (best,) = known.signatures(vector[None])
    runs = {name: outcomes.runs(name, scenario) for name in outcomes.controllers}
    found = {name: _signatures(of, known) for name, of in runs.items()}
    members: dict[Signature, list[Run]] = {_plain(best): []}
    for name, of in runs.items():
        for run, signature in zip(of, found[name], strict=True):
            members.setdefault(signature, []).append(run)
    first, *others = members
    most = sorted(others, key=lambda s: -len(members[s]))[: MOST_NAMED - 1]
    ordered = [first, *sorted(most, key=lambda s: _best(members[s]).final_fitness)]
    letters = dict(zip(ordered, ascii_uppercase, strict=False))
    corridors = []
    for signature, letter in letters.items():
        ended = members[signature]
        path = _best(ended).best_path if ended else problem.points(vector)
        fitness = _best(ended).final_fitness if ended else least
        corridors.append(Corridor(letter, signature, tuple(ended), path, fitness))
    names = {name: [letters.get(signature, OTHERS) for signature in of] for name, of in found.items()}
    return Ends(scenario, least, tuple(corridors), names, len(members) - len(letters))


def corridor_tables(suite: Suite, outcomes: Outcomes) -> list[Table]:  # noqa: ARG001
    """Return a table of the shares of runs by corridor, and one of the corridors themselves."""
    shares: list[Row] = []
    paths: list[Row] = []
    for scenario in outcomes.scenarios:
        ends = ends_of(scenario, outcomes)
        names = [corridor.name for corridor in ends.corridors]
        for group, controllers in outcomes.groups.items():
            ended = {name: ends.shares(controllers, name) for name in (*names, OTHERS)}
            others = (*ascii_uppercase[1:MOST_NAMED], OTHERS)
            shares.append(
                {
                    "scenarios": scenario,
                    "controller": label(group),
                    OPTIMAL: share_in(*outcomes.sample(group, scenario).mean(ended[OPTIMAL])),
                    **{name: share(ended[name].mean()) if name in ended else MISSING for name in others},
                }
            )
        total = sum(map(len, ends.names.values()))
        for corridor in ends.corridors:
            gaps = np.array([run.final_fitness / ends.optimum - 1.0 for run in corridor.runs])
            paths.append(
                {
                    "scenarios": scenario,
                    "corridor": corridor.name,
                    "runs": share(len(gaps) / total),
                    "best fitness": number(corridor.fitness, ".3f"),
                    "best gap": share(corridor.fitness / ends.optimum - 1.0, ".2f"),
                    "median gap": share(np.median(gaps) if len(gaps) else np.nan, ".2f"),
                    "other corridors": number(ends.pooled, "d"),
                }
            )
    return [
        Table.of(
            "corridors",
            "Share of the runs that end in each corridor. A is the corridor of the optimum [95 % interval]. "
            "The letters after it are ordered by the best path in them, on each scenario anew. Paths that "
            "still collide count, too",
            shares,
        ),
        Table.of(
            "corridor-paths",
            "Corridors in which most runs of all controllers end: share of these runs, fitness and gap of "
            "the best path in the corridor, median gap of the runs that end there, and the number of "
            "corridors without a letter",
            paths,
        ),
    ]


def _signatures(runs: list[Run], corridors: Corridors) -> list[Signature]:
    paths = np.array([run.best_path for run in runs])
    return [_plain(signature) for signature in signatures(paths, corridors.posts)]


def _plain(signature: np.ndarray) -> Signature:
    return tuple(signature.tolist())


def _best(runs: list[Run]) -> Run:
    return min(runs, key=lambda run: run.final_fitness)

"""Tables of the paper of Brand and Yu: fireflies by their number, and beside ants by the size of the grid."""

from dataclasses import dataclass, replace

import numpy as np
from scipy import stats

from experiments.runs.labels import OPTIMIZER_LABELS
from experiments.runs.outcomes import Floats, Outcomes
from experiments.runs.run import Run, arrives, trajectory_of, turning_of
from experiments.runs.suite import Suite
from experiments.studies.brand_yu.suites import ANTS, TABLE_1
from experiments.tables.cell import Cell, Entry, count_of, mean_cell, number, percent, share
from experiments.tables.claim_tables import Claim, claims_table
from experiments.tables.document import document_of_suite
from experiments.tables.table import Row, Table
from swarm_gym.comparing.entrants import entrant
from swarm_gym.controllers.names import ControllerName
from swarm_gym.problem.geometry.polylines import length_of
from swarm_gym.reference import shortest_grid_path, shortest_path
from swarm_gym.scenarios import GridScenario, make_scenario, worlds_of

# Bounds of the claims about glowworms, and about ants.
MOST_ABOVE_OPTIMUM, MOST_ABOVE_OCTILE = 0.08, 0.10
OCTILE_SIDES = (50, 100, 200)


@dataclass(frozen=True)
class RunsOnMap:
    """Runs of one optimizer and population size on one map.

    Attributes:
        method: display name of the optimizer.
        count: members of the population.
        scenario: scenario at the end of the runs.
        changed: iteration after which the scenario changed last; 0 if it never did.
        runs: runs by seed.
    """

    method: str
    count: int
    scenario: GridScenario
    changed: int
    runs: list[Run]

    @property
    def arrived(self) -> list[Run]:
        """Runs that came to the target."""
        return [run for run in self.runs if arrives(run, self.scenario.target)]

    @property
    def lengths(self) -> Floats:
        """Lengths of the trajectories of runs that arrived, in map units."""
        return np.array([length_of(trajectory_of(run)) for run in self.arrived])

    @property
    def least(self) -> Floats:
        """Shortest lengths that were possible for the same runs, from where they were when the map changed.

        Until then robots have gone on at every iteration, as they do while they see the target.
        """
        found = []
        for run in self.arrived:
            gone = trajectory_of(run)[: self.changed + 1] if self.changed else np.array([self.scenario.start])
            start = (float(gone[-1, 0]), float(gone[-1, 1]))
            found.append(length_of(gone) + shortest_path(replace(self.scenario, start=start))[0])
        return np.array(found)

    @property
    def turnings(self) -> Floats:
        """Turning of the trajectories of runs that arrived, in degrees."""
        return np.array([turning_of(trajectory_of(run)) for run in self.arrived])

    @property
    def iterations(self) -> Floats:
        """Iterations of runs that arrived."""
        return np.array([np.isfinite(run.course("best_fitness")).sum() - 1.0 for run in self.arrived])

    @property
    def seconds(self) -> Floats:
        """Processor time of all runs, in seconds."""
        return np.array([run.seconds for run in self.runs])


def count_tables(suite: Suite, outcomes: Outcomes) -> list[Table]:
    """Return table 1, lengths and times by the number of fireflies, and the claims about them."""
    (scenario,) = suite.scenarios
    walks = [_walks(suite, outcomes, name, scenario) for name in suite.controllers]
    optimum = shortest_path(walks[0].scenario)[0]
    is_published = not walks[0].changed  # the paper of Brand and Yu has no numbers of maps that change
    rows: list[dict[str, Entry]] = []
    for walk in walks:
        rows.append(
            {
                "fireflies": number(walk.count, "d"),
                "arrived": count_of(len(walk.arrived), len(walk.runs)),
                "mean length": mean_cell(walk.lengths),
                "above the shortest": share(_excess(walk)),
                "iterations": mean_cell(walk.iterations, ".0f"),
                "turning, degrees": mean_cell(walk.turnings, ".0f"),
                "seconds": number(walk.seconds.mean(), ".3f"),
            }
        )
        if is_published:
            row = TABLE_1.get(walk.count)
            rows[-1]["length, paper"] = number(row.length if row else None, ".0f")
            rows[-1]["seconds, paper"] = number(row.seconds if row else None)
    named = {f"{walk.count} fireflies": walk for walk in walks}
    claims = [
        Claim("all runs arrive", {n: len(walk.arrived) == len(walk.runs) for n, walk in named.items()}),
        Claim(
            f"mean length within {percent(MOST_ABOVE_OPTIMUM, '.0f')} of the shortest possible",
            {n: bool(walk.lengths.size) and _excess(walk) <= MOST_ABOVE_OPTIMUM for n, walk in named.items()},
        ),
    ]
    return [
        claims_table(
            f"{suite.name}-claims",
            f"What is said of fireflies on {scenario}, and where it does not hold",
            claims,
        ),
        Table.of(
            f"{suite.name}-counts",
            f"{'Table 1, on' if is_published else 'On'} {scenario}, whose shortest path is {optimum:.1f}: "
            "means [95 % intervals] over the runs that arrived, of the way that the robot went, of "
            "iterations, and of all turns on the way; processor time of a run. "
            + (
                "Start, goal and obstacle of the paper are not known"
                if is_published
                else "The shortest way is that from where the robot was when the map changed, and what it "
                "had gone"
            ),
            rows,
        ),
    ]


def grid_tables(suite: Suite, outcomes: Outcomes) -> list[Table]:
    """Return figures 8 and 9 as tables: length and time against the size of the grid, and exponents."""
    sides = [int(name.partition(":")[2]) for name in suite.scenarios]
    walks = {
        (controller, side): _walks(suite, outcomes, controller, name)
        for side, name in zip(sides, suite.scenarios, strict=True)
        for controller in suite.controllers
    }
    optima = {side: _optima(walks[suite.controllers[0], side].scenario) for side in sides}
    rows: list[Row] = [
        {
            "grid": f"{side} x {side}",
            "method": walk.method,
            "arrived": count_of(len(walk.arrived), len(walk.runs)),
            "mean length": mean_cell(walk.lengths),
            "above shortest path": share(_mean_of(walk.lengths) / optima[side][0] - 1.0),
            "against octile": share(_mean_of(walk.lengths) / optima[side][1] - 1.0, "+.1f"),
            "seconds": number(walk.seconds.mean(), ".3f"),
        }
        for (_, side), walk in walks.items()
    ]
    slopes = [
        (
            walks[controller, sides[0]].method,
            *_slope(sides, [walks[controller, side].lengths for side in sides]),
            *_slope(sides, [walks[controller, side].seconds for side in sides]),
        )
        for controller in suite.controllers
    ]
    tables = [
        Table.of(
            f"{suite.name}-lengths",
            "Length and time against the size of the grid (figures 8 and 9): means [95 % intervals] of the "
            "way that the robot of the glowworms went and of the best path of the ants; above the shortest "
            "path at any angle, and above the shortest one in steps to eight neighbours; processor time "
            "of a run",
            rows,
        ),
        Table(
            f"{suite.name}-exponents",
            f"Exponents p of side^p fitted to lengths and to times on grids of {sides[0]} to {sides[-1]} "
            "(least squares in logarithms over all runs, 95 % intervals)",
            ("method", "p of the length", "interval", "p of the time", "interval"),
            slopes,
        ),
    ]
    if ANTS in suite.controllers:
        tables.insert(0, _grid_claims(suite, walks, optima, sides))
    return tables


def _grid_claims(
    suite: Suite,
    walks: dict[tuple[str, int], RunsOnMap],
    optima: dict[int, tuple[float, float]],
    sides: list[int],
) -> Table:
    ants = {side: walks[ANTS, side] for side in sides}
    return claims_table(
        f"{suite.name}-claims",
        "What is said of ants on growing grids, and where it does not hold",
        [
            Claim(
                "ants arrive in every run",
                {f"{side} x {side}": len(walk.arrived) == len(walk.runs) for side, walk in ants.items()},
            ),
            Claim(
                f"the ants' best paths are within {percent(MOST_ABOVE_OCTILE, '.0f')} of the shortest in "
                "steps to eight neighbours, on average",
                {
                    f"{side} x {side}": _mean_of(walk.lengths) <= (1.0 + MOST_ABOVE_OCTILE) * optima[side][1]
                    for side, walk in ants.items()
                    if side in OCTILE_SIDES
                },
            ),
        ],
    )


def _walks(suite: Suite, outcomes: Outcomes, controller: str, scenario: str) -> RunsOnMap:
    runs = entrant(controller, suite.optimizer)
    changed, made = worlds_of(make_scenario(scenario))[-1]
    assert isinstance(made, GridScenario)
    return RunsOnMap(
        OPTIMIZER_LABELS.get(runs.optimizer, runs.optimizer),
        int(ControllerName.parse(runs.controller).argument),
        made,
        changed,
        outcomes.runs(controller, scenario),
    )


def _optima(scenario: GridScenario) -> tuple[float, float]:
    """Return the lengths of the shortest path at any angle, and in steps to eight neighbours."""
    grid = scenario.map
    ends = (grid.cell_of(point) for point in (scenario.start, scenario.target))
    return shortest_path(scenario)[0], shortest_grid_path(grid.blocked, *ends).length * grid.resolution


def _slope(sides: list[int], values: list[Floats]) -> tuple[Entry, Entry]:
    """Return the exponent and its interval, over all runs."""
    x = np.concatenate([np.full(len(v), np.log(side)) for side, v in zip(sides, values, strict=True)])
    fit = stats.linregress(x, np.log(np.concatenate(values)))
    margin = stats.t.ppf(0.975, len(x) - 2) * fit.stderr
    ends = Cell.of("[{low:.2f}, {high:.2f}]", low=fit.slope - margin, high=fit.slope + margin)
    return number(fit.slope, ".2f"), ends


def _excess(walk: RunsOnMap) -> float:
    """Return the mean length above the mean of the shortest possible lengths, relative to the latter."""
    return _mean_of(walk.lengths) / _mean_of(walk.least) - 1.0


def _mean_of(values: Floats) -> float:
    return float(values.mean()) if values.size else np.nan


TABLES = {"brand-yu-counts": count_tables, "brand-yu-grids": grid_tables}
DOCUMENTS = {"brand-yu": (document_of_suite("docs/brand-yu-paper.md", "brand-yu"),)}

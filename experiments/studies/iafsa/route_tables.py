"""The route tables of the IAFSA paper, on our maps: swarms beside A* and the shortest path at any angle.

Runs of two optimizers on one route are independent, and not all may be feasible. Mann-Whitney's U test
compares their lengths.
"""

import numpy as np

from experiments.runs.labels import OPTIMIZER_LABELS
from experiments.runs.outcomes import Floats, Outcomes
from experiments.runs.suite import Suite
from experiments.statistics import holm, rank_sum
from experiments.studies.iafsa.published import AFSA, ROUTE_LENGTHS
from experiments.studies.iafsa.routes import A_STAR, Route, make_route
from experiments.tables.cell import MISSING, Entry, mean_cell, number, share
from experiments.tables.claim_tables import Claim, claims_table
from experiments.tables.table import Row, Table
from swarm_gym.comparing.entrants import entrant
from swarm_gym.problem.geometry.polylines import length_of
from swarm_gym.scenarios.papers.iafsa import SITES


def route_tables(suite: Suite, outcomes: Outcomes) -> list[Table]:
    """Return the lengths of routes (tables 4 and 5), and the claims about them."""
    routes = find_routes(suite, outcomes)
    p_values = {
        (route.label, optimizer): rank_sum(route.lengths(optimizer), route.lengths(AFSA))
        for route in routes
        for optimizer in route.runs
        if optimizer != AFSA and AFSA in route.runs
        if min(route.lengths(optimizer).size, route.lengths(AFSA).size) > 1
    }
    adjusted = dict(zip(p_values, holm(list(p_values.values())), strict=True))
    rows: list[Row] = []
    for route in routes:
        length, points = route.shortest
        rows.append(_row(route, "shortest path", np.array([length]), route.clearance(points)))
        rows += [_grid_row(route, method) for method in route.cell_paths]
        rows += [_swarm_row(route, o, adjusted.get((route.label, o))) for o in route.runs]
    radii = " and ".join(f"{site.radius:g} ({name}, {site.robot})" for name, site in SITES.items())
    return [
        claims_table(
            "iafsa-routes-claims",
            f"What is said of the routes, over {suite.num_seeds} runs, and where it does not hold",
            _claims(routes),
        ),
        Table.of(
            "iafsa-routes",
            f"Tables 4 and 5. Mean length [95 % interval] of the feasible runs of {suite.num_seeds}, in "
            "metres, above the shortest path at any angle on the map inflated for the robot; against A* on "
            "that map, negative where shorter; p of Mann-Whitney's U test, two-sided, Holm-corrected over "
            f"the table; least distance of any run from an obstacle, to be {radii} at least; what A* "
            "evaluates is cells. The paper's lengths are of other maps",
            rows,
        ),
    ]


def find_routes(suite: Suite, outcomes: Outcomes) -> list[Route]:
    """Return the routes of a suite with its runs, in its order."""
    optimizers = {name: entrant(name, suite.optimizer).optimizer for name in suite.controllers}
    return [
        make_route(name, {optimizers[c]: outcomes.runs(c, name) for c in suite.controllers})
        for name in suite.scenarios
    ]


def _row(route: Route, method: str, lengths: Floats, clearance: float, **others: Entry) -> Row:
    """Return the row of a method with the lengths of its feasible paths; `others` are further entries."""
    mean = float(np.mean(lengths)) if lengths.size else np.nan
    return {
        "route": route.label,
        "method": method,
        "feasible": number(1.0, ".2f"),
        "mean length": mean_cell(lengths, ".3f"),
        "shortest": number(lengths.min() if lengths.size else None, ".3f"),
        "above shortest path": share(mean / route.shortest[0] - 1.0),
        "against A*": share(mean / route.mean(A_STAR) - 1.0, "+.1f"),
        "p against AFSA": MISSING,
        "least clearance": number(clearance, ".3f"),
        "evaluations": MISSING,
        "paper": MISSING,
        **others,
    }


def _grid_row(route: Route, method: str) -> Row:
    path = route.cell_paths[method]
    return _row(
        route,
        method,
        np.array([length_of(path)]),
        route.clearance(path),
        evaluations=number(route.a_star.expansions, ","),
        paper=_published(route, "a-star") if method == A_STAR else MISSING,
    )


def _swarm_row(route: Route, optimizer: str, p_value: float | None) -> Row:
    runs, lengths = route.runs[optimizer], route.lengths(optimizer)
    others = {
        "feasible": number(lengths.size / len(runs), ".2f"),
        "p against AFSA": number(p_value, ".1g"),
        "evaluations": number(np.mean([run.evaluations for run in runs]), ",.0f"),
        "paper": _published(route, optimizer),
    }
    label = OPTIMIZER_LABELS.get(optimizer, optimizer)
    return _row(route, label, lengths, float(route.clearances(optimizer).min()), **others)


def _published(route: Route, method: str) -> Entry:
    return number(ROUTE_LENGTHS.get((route.site, route.pair, method)), ".3f")


def _claims(routes: list[Route]) -> list[Claim]:
    return [
        Claim(
            f"all runs of {OPTIMIZER_LABELS.get(optimizer, optimizer)} keep the robot clear of obstacles",
            {r.label: bool((r.clearances(optimizer) >= SITES[r.site].radius).all()) for r in routes},
        )
        for optimizer in dict.fromkeys(optimizer for route in routes for optimizer in route.runs)
    ]

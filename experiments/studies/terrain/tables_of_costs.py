"""Tables of this study: excess over the best known flights in short, and costs by terrain."""

from collections.abc import Mapping, Sequence

import numpy as np

from experiments.studies.terrain.measured_costs import Asked, Floats
from experiments.studies.terrain.rows import PEERS, PLANNED
from experiments.tables import Table
from experiments.tables.cell import Entry, number

# Of each library the row with the least mean excess after 2,500 evaluations.
FIRST_OF_LIBRARIES = (
    "cmaes CMA-ES, spherical", "pymoo DE, waypoints", "niapy L-SHADE, waypoints", "mealpy L-SHADE, waypoints"
)  # fmt: skip
# Rows that have a column in the table by terrain, where they are there.
SHOWN = (
    "PSO, spherical, uniform", "L-SHADE, spherical, uniform", "L-SHADE, waypoints, smooth",
    "L-SHADE, waypoints, guided", "CMA-ES, waypoints, guided", "fireflies, waypoints, guided",
    "fireflies, SPSFA-TIP, waypoints, guided", "multivariate, waypoints, guided",
    "multivariate, shifted, guided", "L-SHADE, shifted, guided",
    "L-SHADE, linear reduction, shifted, guided", "L-SHADE, SPSFA-TIP, tuned, shifted, guided",
    "L-SHADE, SPSFA-TIP, tuned, waypoints, guided", "L-SHADE, learned, size and phi, waypoints, guided",
    "L-SHADE, learned, with sources, waypoints, guided", *FIRST_OF_LIBRARIES, *PLANNED.values(),
)  # fmt: skip

# Rows of docs/terrain.md, over all test terrains; its appendix has all.
IN_SHORT = (
    "L-SHADE, blind schedule, with sources, shifted, guided", "multivariate, shifted, guided",
    "L-SHADE, SPSFA-TIP, tuned, shifted, guided", "L-SHADE, shifted, guided",
    "L-SHADE, learned, with sources, shifted, guided", "L-SHADE, SPSFA-TIP, tuned, waypoints, guided",
    *PLANNED.values(), "mealpy L-SHADE, waypoints", "PSO, spherical, uniform",
)  # fmt: skip
# Rows of that page after more evaluations.
LONGER = (
    "L-SHADE, linear reduction, shifted, guided", "L-SHADE, shifted, guided",
    "multivariate, shifted, guided", "L-SHADE, linear reduction, waypoints, guided",
    "L-SHADE, SPSFA-TIP, tuned, shifted, guided", "multivariate, waypoints, guided",
    "L-SHADE, waypoints, smooth", "multivariate, waypoints, smooth",
    "L-SHADE, spherical, uniform", "PSO, spherical, uniform",
)  # fmt: skip


# Rows of docs/terrain-budgets.md, after 20,000 evaluations and after 100,000; its appendix has all.
BUDGETS = (
    "L-SHADE, linear reduction, shifted, guided", "L-SHADE, linear reduction, waypoints, guided",
    "L-SHADE, SPSFA-TIP, tuned, waypoints, guided",
    "L-SHADE, learned, with sources, waypoints, guided", PLANNED["shifted"],
    "cmaes CMA-ES, spherical", "pymoo DE, waypoints", "niapy L-SHADE, waypoints", "mealpy L-SHADE, waypoints",
)  # fmt: skip
COSTS_AFTER_20_000 = (*BUDGETS, "L-SHADE, linear reduction, waypoints, uniform")
COSTS_AFTER_100_000 = (*BUDGETS, PLANNED["waypoints"])


def tables(
    measured: Mapping[str, Floats], terrains: Sequence[str], asked: Asked, best: Floats
) -> list[Table]:
    """Return all tables.

    Args:
        measured: best costs, (terrains, budgets, runs), by the name of the row.
        terrains: names of the terrains.
        asked: runs of each row.
        best: (terrains,) costs that the excess is measured from, see `best_costs`.
    """
    return [_in_short(measured, terrains, asked, best), _by_terrain(measured, terrains, asked, best)]


def best_costs(measured: Mapping[str, Floats], known: Floats) -> Floats:
    """Return the (terrains,) costs of the best known flights, or of the best runs where none is known.

    Args:
        measured: best costs, (terrains, budgets, runs), by the name of the row.
        known: (terrains,) costs of the best known flights; infinite where none is known.
    """
    found = np.min([costs.min(axis=(1, 2)) for costs in measured.values()], axis=0)
    return np.where(np.isfinite(known), known, found)


def excess_of(costs: Floats, best: Floats) -> Floats:
    """Return how far costs, (terrains, ...), are above the best ones, (terrains,), in per cent of these."""
    return 100.0 * (costs / best.reshape(-1, *(1,) * (costs.ndim - 1)) - 1.0)


def _in_short(measured: Mapping[str, Floats], terrains: Sequence[str], asked: Asked, best: Floats) -> Table:
    found: list[tuple[float, dict[str, Entry]]] = []
    peer = _best_peer(measured, best)
    for name, costs in measured.items():
        excess = excess_of(costs, best)  # (terrains, budgets, runs)
        row: dict[str, Entry] = {"optimizer, encoding, source": name}
        for k, evaluations in enumerate(asked.evaluations):
            row[f"mean excess, {evaluations:,}"] = number(excess[:, k].mean(), ".1f")
            row[f"median, {evaluations:,}"] = number(np.median(excess[:, k]), ".1f")
        row["first on terrains"] = number(_firsts(measured, name), ".0f")
        if peer:
            row["below the best peer"] = _below(measured, name, peer)
        found.append((float(excess[:, 0].mean()), row))
    below = ""
    if peer:
        below = (
            f"Below the best peer: terrains on which the mean after {asked.evaluations[0]:,} is below that "
            f"of {peer}, the library row with the least mean excess. "
        )
    caption = (
        f"Excess of the cost `{asked.cost}` over the best known flight, in per cent: mean and median over "
        f"{len(terrains)} terrains ({listed(terrains)}) and {asked.in_words(peers=bool(peer))}, after so "
        f"many evaluations. First on terrains: where the mean after {asked.evaluations[0]:,} is the least of "
        f"all {len(measured)} rows of these runs. "
        f"{below}What planning takes is not in the evaluations"
    )
    rows = [row for _, row in sorted(found, key=lambda one: one[0])]
    return Table.of(f"{asked.cost}-in-short", caption, rows)


def _best_peer(measured: Mapping[str, Floats], best: Floats) -> str | None:
    """Return the library row with the least mean excess after the first budget; None if there is none."""
    excess = {
        name: float((costs[:, 0] / best[:, None]).mean())
        for name, costs in measured.items()
        if _is_peer(name)
    }
    return min(excess, key=lambda name: excess[name], default=None)


def _is_peer(name: str) -> bool:
    """Return whether a row is of another library."""
    return name.rpartition(", ")[0] in PEERS


def _below(measured: Mapping[str, Floats], name: str, peer: str) -> Entry:
    """Return on how many terrains the mean cost of a row after the first budget is below that of a peer."""
    below = measured[name][:, 0].mean(axis=1) < measured[peer][:, 0].mean(axis=1)
    return number(int(below.sum()), ".0f")


def _firsts(measured: Mapping[str, Floats], name: str) -> int:
    """Return on how many terrains the mean cost of a row after the first budget is the least."""
    means = {other: costs[:, 0].mean(axis=1) for other, costs in measured.items()}
    least = np.min(list(means.values()), axis=0)
    return int((means[name] <= least).sum())


def _by_terrain(measured: Mapping[str, Floats], terrains: Sequence[str], asked: Asked, best: Floats) -> Table:
    rows = []
    for k, terrain in enumerate(terrains):
        row: dict[str, Entry] = {"terrain": terrain, "best": number(float(best[k]), ".0f")}
        for name, costs in measured.items():
            if name in SHOWN:
                row[name] = number(float(costs[k, 0].mean()), ".0f")
        rows.append(row)
    peers = any(name in SHOWN for name in measured if _is_peer(name))
    caption = (
        f"Mean of the cost `{asked.cost}` after {asked.evaluations[0]:,} evaluations by terrain, over "
        f"{asked.in_words(peers=peers)}, and the cost of the best known flight"
    )
    return Table.of(f"{asked.cost}-by-terrain", caption, rows)


def listed(terrains: Sequence[str]) -> str:
    """Return the names of terrains, those with consecutive numbers as the first and the last of them."""
    if len(terrains) <= 8:
        return ", ".join(terrains)
    parts: list[tuple[str, str]] = []
    for name in terrains:
        family, _, number = name.rpartition(":")
        if parts and number.isdecimal() and parts[-1][1] == f"{family}:{int(number) - 1}":
            parts[-1] = parts[-1][0], name
        else:
            parts.append((name, name))
    return ", ".join(one if one == last else f"{one} to {last}" for one, last in parts)

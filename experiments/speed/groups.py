"""The groups of quantities that the benchmark measures; each is a module of this package."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

from tqdm import tqdm

from experiments.speed import environments, growth, moves, rendering, start, threads, training
from experiments.speed.measurement import Measurement, Quantity, measure
from swarm_gym.checks import look_up
from swarm_gym.warm_up import warm_up


@dataclass(frozen=True)
class Group:
    """A group of the benchmark.

    Attributes:
        quantities: function that yields the quantities to measure.
        summary: function that computes further numbers from their measurements.
    """

    quantities: Callable[[], Iterator[Quantity]]
    summary: Callable[[list[Measurement]], list[Measurement]] = lambda _: []


GROUPS: dict[str, Group] = {
    "moves": Group(moves.quantities, moves.summary),
    "environments": Group(environments.quantities),
    "threads": Group(threads.quantities),
    "growth": Group(growth.quantities, growth.summary),
    "start": Group(start.quantities),
    "training": Group(training.quantities),
    "rendering": Group(rendering.quantities),
}


def measure_groups(names: Sequence[str], repeats: int) -> dict[str, list[Measurement]]:
    """Return the measurements of groups, by their names.

    Args:
        names: names in `GROUPS`.
        repeats: number of runs for each quantity that does not have its own.

    Raises:
        UnknownNameError: if there is no group of a name.
    """
    groups = {name: look_up("group", name, GROUPS) for name in names}
    warm_up()
    plan = [(name, quantity) for name, group in groups.items() for quantity in group.quantities()]
    measured: dict[str, list[Measurement]] = {name: [] for name in groups}
    with tqdm(plan, unit="figure", desc="benchmark") as bar:
        for name, quantity in bar:
            bar.set_postfix_str(quantity.name)
            measured[name].append(measure(quantity, repeats))
    return {name: measured[name] + group.summary(measured[name]) for name, group in groups.items()}

"""The beginnings of episodes: the options of `reset`, and what seeds decide.

The options are the scenario, and the size, source or content of the first population.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from numbers import Real
from typing import Any, NamedTuple, TypeAlias, cast

import numpy as np
from numpy.typing import NDArray

from swarm_gym.compiler import first_draws
from swarm_gym.compiler.random_stream import NUM_SEED_WORDS, seed_streams
from swarm_gym.compiler.seed_sequence import generated, spawned
from swarm_gym.errors import SettingError, UnknownNameError, shown
from swarm_gym.measures import prices_at
from swarm_gym.optimizers.optimizer import Optimizer
from swarm_gym.settings import Settings
from swarm_gym.sources import Source
from swarm_gym.worlds import Worlds

Floats = NDArray[np.float64]
Words = NDArray[np.uint64]

# Seeds of k episodes: the entropies of k seed sequences, (k, words), or the sequences themselves.
Seeds: TypeAlias = NDArray[np.uint32] | Sequence[np.random.SeedSequence]

SOURCE_OPTIONS = ("smooth_share", "amplitude")
RESET_OPTIONS = ("scenario", "initial_population", "initial_population_size", *SOURCE_OPTIONS)


class Beginning(NamedTuple):
    """The beginning of episodes.

    Attributes:
        size: size of the first population.
        population: decision vectors of its members, (size, dimension); None if they are drawn.
        scenario: number of the scenario; None if the seed draws it.
        source: source of the members, if they are drawn.
    """

    size: int
    population: Floats | None
    scenario: int | None
    source: Source


class Drawn(NamedTuple):
    """The parts of k beginnings that are drawn.

    Attributes:
        problem: (k,) numbers of the first problems.
        price: (k,) costs of `reference_evaluations` evaluations.
        stream: (k, 4, 8) random streams, uint64.
    """

    problem: NDArray[np.int64]
    price: Floats
    stream: NDArray[np.uint64]


def draw_beginnings(seeds: Seeds, settings: Settings, worlds: Worlds, scenario: int | None) -> Drawn:
    """Return what k seeds draw; the scenario is this one for all of them if it is not None.

    The first child of a seed draws scenario and price, and the second is the seed of the random stream.
    """
    for_numbers, for_streams = _words_of_children(seeds)
    numbers, shares = first_draws.integers_and_shares(for_numbers, len(worlds.first))
    if scenario is not None:
        numbers[:] = scenario
    return Drawn(worlds.first[numbers], prices_at(shares, settings), seed_streams(for_streams))


def _words_of_children(seeds: Seeds) -> tuple[Words, Words]:
    """Return the words that two children of each seed generate, (k, 4) and (k, 24), as NumPy spawns them."""
    counts = first_draws.NUM_SEED_WORDS, NUM_SEED_WORDS
    if isinstance(seeds, np.ndarray):
        first, second = (generated(spawned(seeds, child), counts[child]) for child in (0, 1))
        return first, second
    spawned_by_numpy = [seed.spawn(2) for seed in seeds]
    first, second = (
        np.array([pair[child].generate_state(counts[child], np.uint64) for pair in spawned_by_numpy])
        for child in (0, 1)
    )
    return first.reshape(-1, counts[0]), second.reshape(-1, counts[1])


def read_reset_options(
    options: Mapping[str, object] | None, settings: Settings, optimizer: type[Optimizer], worlds: Worlds
) -> Beginning:
    """Return how episodes begin with these options; what they leave out is as in the settings.

    Raises:
        UnknownNameError: for an option or scenario that does not exist.
        SettingError: for a value that an option cannot have.
    """
    options = {} if options is None else options
    if not isinstance(options, Mapping):
        raise SettingError(f"options must be a mapping from names to values, got {shown(options)}")
    for name in options:
        if name not in RESET_OPTIONS:
            raise UnknownNameError("reset option", name, RESET_OPTIONS)
    scenario = None
    if "scenario" in options:
        names = worlds.scenario_names
        if not isinstance(options["scenario"], str) or options["scenario"] not in names:
            raise UnknownNameError("scenario of this environment", options["scenario"], names)
        if names.count(options["scenario"]) > 1:
            raise SettingError(
                f"scenario {options['scenario']!r}: several scenarios of this environment have this name"
            )
        scenario = names.index(options["scenario"])
    size = options.get("initial_population_size", settings.initial_population_size)
    population = None
    if "initial_population" in options:
        if not optimizer.adopts:
            raise SettingError(
                f"initial_population: {optimizer.name} makes its first population itself; use "
                "initial_population_size"
            )
        for name in ("initial_population_size", *SOURCE_OPTIONS):
            if name in options:
                raise SettingError(f"expected initial_population or {name}, got both")
        population = _read_population(options["initial_population"], worlds, scenario)
        size = len(population)
    name = "initial_population_size" if population is None else "the size of initial_population"
    settings.check_population_size(name, size)
    size = cast(int, size)
    budget = settings.max_evaluations
    if budget is not None and size > budget:
        raise SettingError(f"{name} must be at most max_evaluations, {budget}, got {size}")
    return Beginning(int(size), population, scenario, _read_source(options, settings))


def _read_source(options: Mapping[str, object], settings: Settings) -> Source:
    """Return the source of a first population, as the settings have it, with what the options change."""
    given = {name: options[name] for name in SOURCE_OPTIONS if name in options}
    for name in given:
        settings.require_sources(name)
    source = replace(settings.new_members, **cast(dict[str, float], given))  # which checks them
    if "amplitude" in given and "smooth_share" not in given and source.smooth_share == 0.0:
        raise SettingError(
            "amplitude has no effect with uniform members; remove it, or give smooth_share in (0, 1], too"
        )
    return source


def _are_numbers(array: NDArray[Any]) -> bool:
    """Return whether an array has real numbers only, and no booleans."""
    if array.dtype.kind != "O":
        return array.dtype.kind in "fiu"
    return all(isinstance(one, Real) and not isinstance(one, bool) for one in array.flat)


def _read_population(population: object, worlds: Worlds, scenario: int | None) -> Floats:
    n = worlds.problems[0].dimension
    try:
        given = np.asarray(population)
        if not _are_numbers(given) or np.ma.is_masked(population):
            raise TypeError
        with np.errstate(over="ignore"):  # becomes infinite, which is refused below
            array = given.astype(np.float64)
    except Exception as error:  # an object that converts itself to an array can raise anything
        raise SettingError(f"initial_population must be numbers, got {shown(population)}") from error
    if array.ndim != 2 or array.shape[1] != n:
        raise SettingError(f"initial_population must have shape (members, {n}), got {array.shape}")
    lower, upper = (bounds[:n] for bounds in worlds.common_bounds(scenario))
    inside = (array >= lower) & (array <= upper)
    if not inside.all():
        member, component = np.argwhere(~inside)[0]
        several = scenario is None and len(worlds.first) > 1
        whose = " of all scenarios, unless `scenario` names one" if several else ""
        raise SettingError(
            f"initial_population must be finite and inside the bounds of decision vectors{whose}: component "
            f"{component} of member {member} must lie in [{lower[component]:g}, {upper[component]:g}], got "
            f"{array[member, component]:g}"
        )
    return array

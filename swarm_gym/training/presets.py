"""Presets: training configurations as data, in `swarm_gym/training/presets/<name>.toml`.

Those of studies are in `experiments/studies/<study>/data/presets`.

A preset may name another one in its entry `like`; it then states only the options that differ. The learning
algorithm and its options are in a table:

    total_steps = 1_000_000

    [algorithm]
    name = "evolution"
    candidates = 32

Without a name, the table is for the algorithm of the preset in `like`. Another algorithm takes over the
options that both have, and its other options begin from their defaults. Presets of earlier versions have no
table: `algorithm = "evolution"`, and its options stand among the others. They are read as before, and may
state options that the algorithm lacks, as long as these have no effect.
"""

import tomllib
from pathlib import Path
from typing import Any, cast, get_args, get_origin, get_type_hints

from swarm_gym.controllers.packaged import MAX_TEXT_FILE, Packaged, read_bytes
from swarm_gym.errors import UnknownNameError, shown
from swarm_gym.own_code import is_own, own
from swarm_gym.training.algorithms import EVERY_OPTION, PPO, foreign_options
from swarm_gym.training.config import SHARED, TrainConfig
from swarm_gym.training.own_names import refuse_own_code

PRESETS = Packaged(Path(__file__).parent / "presets", ".toml")

_HINTS = get_type_hints(TrainConfig)
# Types of the entries outside the table of the algorithm; those of the algorithm are of earlier versions.
_ENTRIES: dict[str, Any] = {
    **{name: _HINTS[name] for name in SHARED if name != "preset"},
    "algorithm": str,
    **{name: kind for name, (kind, _) in EVERY_OPTION.items()},
}
_IN_TOML = {bool: "boolean", int: "integer", float: "float", str: "string", Path: "string"}


class PresetError(ValueError):
    """A preset that is missing or has an invalid entry; the message names the file and the entry."""


def preset_names() -> list[str]:
    """Return the names of the presets."""
    return PRESETS.names()


def load_preset(name: str) -> TrainConfig:
    """Return the configuration of a preset by its name, of a TOML file by its path, or of own code.

    Raises:
        PresetError: if the file is missing or no TOML, has an unknown key or a value of a wrong type, or if
            the preset in its entry `like` is invalid.
        OwnCodeError: if own code cannot be imported, or is no configuration; or if a file names own code.
    """
    if PRESETS.find(name) is None and is_own("preset", name):
        found = own("preset", name, lambda found: isinstance(found, TrainConfig), "a TrainConfig")
        return cast(TrainConfig, found)
    values, path = _load(name, ())
    try:
        return TrainConfig().changed(**values)
    except ValueError as error:
        raise PresetError(f"{path}: {error}") from error


def _load(name: str, dependents: tuple[Path, ...]) -> tuple[dict[str, Any], Path]:
    """Return the options that a preset states, and its file.

    Args:
        name: name or file of the preset.
        dependents: files whose `like` led here, in order.
    """
    path = PRESETS.find(name)
    if path is None:
        raise PresetError(PRESETS.missing("preset", name))
    try:
        content = tomllib.loads(read_bytes(path, MAX_TEXT_FILE).decode())
    # Bytes that are no UTF-8, and numbers of thousands of digits, raise ValueError too.
    except (OSError, ValueError, RecursionError) as error:
        raise PresetError(f"{path}: not a readable preset ({error})") from error
    values: dict[str, Any] = {}
    if "like" in content:
        like = _as(str, content.pop("like"), f"{path}: like")
        if path in dependents:
            raise PresetError(f"{path}: it is like itself, through {shown(like)}")
        try:
            values, _ = _load(like, (*dependents, path))
        except PresetError as error:
            raise PresetError(f"{path}: like {shown(like)}: {error}") from error
    stated = {"preset": path.stem}
    table = content.pop("algorithm", {})
    if not isinstance(table, dict):  # the name, in presets of earlier versions
        content["algorithm"], table = table, {}
    stated |= _typed(content, _ENTRIES, "like, ", str(path))
    before = values.get("algorithm", PPO.name)
    try:
        if table:
            stated |= _of_algorithm(table, before, f"{path}: algorithm")
            foreign = foreign_options(stated["algorithm"])
            values = {option: value for option, value in values.items() if option not in foreign}
        if stated.get("algorithm", before) != before and "warm_start" in foreign_options(before):
            values["warm_start"] = "none"  # neither algorithm imitates
    except UnknownNameError as error:
        raise PresetError(f"{path}: {error}") from error
    refuse_own_code(stated, str(path))
    return {**values, **stated}, path


def _of_algorithm(table: dict[str, Any], before: str, where: str) -> dict[str, Any]:
    """Return the name of the algorithm in a table, by default the one before, and the options it states."""
    name = _as(str, table.pop("name", before), f"{where}: name")
    foreign = foreign_options(name)
    kinds = {option: kind for option, (kind, _) in EVERY_OPTION.items() if option not in foreign}
    return {"algorithm": name, **_typed(table, kinds, "name, ", where)}


def _typed(entries: dict[str, Any], kinds: dict[str, Any], more: str, where: str) -> dict[str, Any]:
    """Return entries of a file by name, each of its type."""
    for key in entries:
        if key not in kinds:
            raise PresetError(
                f"{where}: unknown key {shown(key)}, expected one of {more}{', '.join(sorted(kinds))}"
            )
    return {key: _as(kinds[key], value, f"{where}: {key}") for key, value in entries.items()}


def _as(kind: Any, value: Any, where: str) -> Any:
    if get_origin(kind) is tuple:
        if not isinstance(value, list):
            raise PresetError(f"{where} must be a list, got {shown(value)}")
        return tuple(_as(get_args(kind)[0], entry, where) for entry in value)
    if kind is Path and isinstance(value, str):
        return Path(value)
    if kind is float and type(value) is int:
        return float(value)
    if type(value) is not kind:  # a bool is no int here
        raise PresetError(f"{where} must be of type {_IN_TOML[kind]}, got {shown(value)}")
    return value

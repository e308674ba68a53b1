"""Presets: training configurations as data, in `swarm_gym/training/presets/<name>.toml`.

Those of studies are in `experiments/studies/<study>/data/presets`.

A preset may name another one in its entry `like`; it then states only the options that differ.
"""

import dataclasses
import tomllib
from pathlib import Path
from typing import Any, get_args, get_origin, get_type_hints

from swarm_gym.controllers.packaged import MAX_TEXT_FILE, Packaged, read_bytes
from swarm_gym.errors import shown
from swarm_gym.own_code import is_own, own
from swarm_gym.training.config import TrainConfig
from swarm_gym.training.own_names import refuse_own_code

PRESETS = Packaged(Path(__file__).parent / "presets", ".toml")

_HINTS = get_type_hints(TrainConfig)
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
        return own("preset", name, lambda found: isinstance(found, TrainConfig), "a TrainConfig")
    return _load(name, ())


def _load(name: str, dependents: tuple[Path, ...]) -> TrainConfig:
    """Return the configuration of a preset; `dependents` are the files whose `like` led here, in order."""
    path = PRESETS.find(name)
    if path is None:
        raise PresetError(PRESETS.missing("preset", name))
    try:
        content = tomllib.loads(read_bytes(path, MAX_TEXT_FILE).decode())
    # Bytes that are no UTF-8, and numbers of thousands of digits, raise ValueError too.
    except (OSError, ValueError, RecursionError) as error:
        raise PresetError(f"{path}: not a readable preset ({error})") from error
    kinds = {field.name: _HINTS[field.name] for field in dataclasses.fields(TrainConfig)}
    del kinds["preset"]
    start = TrainConfig()
    if "like" in content:
        like = _as(str, content.pop("like"), f"{path}: like")
        if path in dependents:
            raise PresetError(f"{path}: it is like itself, through {shown(like)}")
        try:
            start = _load(like, (*dependents, path))
        except PresetError as error:
            raise PresetError(f"{path}: like {shown(like)}: {error}") from error
    values: dict[str, Any] = {"preset": path.stem}
    for key, value in content.items():
        if key not in kinds:
            raise PresetError(
                f"{path}: unknown key {shown(key)}, expected one of like, {', '.join(sorted(kinds))}"
            )
        values[key] = _as(kinds[key], value, f"{path}: {key}")
    refuse_own_code(values, str(path))
    return dataclasses.replace(start, **values)


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

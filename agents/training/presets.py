"""Presets: training configurations as data, in `agents/training/presets/<name>.toml`.

A preset that is another one but for some options names that one as `like` and states what differs.
"""

import dataclasses
import tomllib
from pathlib import Path
from typing import Any, get_args, get_origin, get_type_hints

from agents.training.config import TrainConfig
from swarm_gym.controllers.packaged import MAX_TEXT_FILE, find_file, read_bytes, shipped_names
from swarm_gym.errors import shown

PRESETS = Path(__file__).parent / "presets"

_HINTS = get_type_hints(TrainConfig)
_IN_TOML = {bool: "boolean", int: "integer", float: "float", str: "string", Path: "string"}


class PresetError(ValueError):
    """A preset is missing or says what cannot be; the message names the file and the entry."""


def preset_names() -> list[str]:
    """Names of the presets."""
    return shipped_names(PRESETS, ".toml")


def load_preset(name: str) -> TrainConfig:
    """The configuration of a preset by name, or of a TOML file by its path.

    Raises:
        PresetError: if there is none, it is not TOML, it has an unknown key or a value of a wrong type, or it
            is like one of which that is so.
    """
    return _load(name, ())


def _load(name: str, dependents: tuple[Path, ...]) -> TrainConfig:
    """A preset that the dependents, each the one before, are like."""
    path = find_file(name, PRESETS, ".toml")
    if path is None:
        raise PresetError(f"preset {shown(name)}: neither one of {', '.join(preset_names())} nor a file")
    try:
        content = tomllib.loads(read_bytes(path, MAX_TEXT_FILE).decode())
    # A ValueError is also what is no UTF-8, and a number of thousands of digits.
    except (OSError, ValueError, RecursionError) as error:
        raise PresetError(f"{path}: not a readable preset ({error})") from error
    kinds = {field.name: _HINTS[field.name] for field in dataclasses.fields(TrainConfig)}
    del kinds["preset"]
    start = TrainConfig()
    if "like" in content:
        like = _as(str, content.pop("like"), f"{path}: like")
        if path in dependents:
            raise PresetError(f"{path}: it is like itself, by way of {shown(like)}")
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

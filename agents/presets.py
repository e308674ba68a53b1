"""Presets: training configurations as data, in `agents/presets/<name>.toml`."""

import dataclasses
import tomllib
from pathlib import Path
from typing import Any

from agents.train_config import TrainConfig

PRESETS = Path(__file__).parent / "presets"


class PresetError(ValueError):
    """A preset is missing or says what cannot be; the message names the file and the entry."""


def preset_names() -> list[str]:
    """Names of the presets."""
    return sorted(path.stem for path in PRESETS.glob("*.toml"))


def load_preset(name: str) -> TrainConfig:
    """The configuration of a preset by name, or of a TOML file by its path.

    Raises:
        PresetError: if there is none, it is not TOML, or it has an unknown key or a value of a wrong type.
    """
    for path in (PRESETS / f"{name}.toml", Path(name)):
        if path.is_file():
            break
    else:
        raise PresetError(f"preset {name!r}: neither one of {', '.join(preset_names())} nor a file")
    try:
        content = tomllib.loads(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise PresetError(f"{path}: not a readable preset ({error})") from error
    defaults = TrainConfig()
    known = {field.name: getattr(defaults, field.name) for field in dataclasses.fields(TrainConfig)}
    values: dict[str, Any] = {"preset": path.stem}
    for key, value in content.items():
        if key not in known:
            raise PresetError(f"{path}: unknown key {key!r}, expected one of {', '.join(sorted(known))}")
        values[key] = _as(type(known[key]), value, f"{path}: {key}")
    return dataclasses.replace(defaults, **values)


def _as(kind: type, value: Any, where: str) -> Any:
    if isinstance(value, list):
        value = tuple(value)
    if kind is float and isinstance(value, int) and not isinstance(value, bool):
        value = float(value)
    if not isinstance(value, kind):
        raise PresetError(f"{where} must be a {kind.__name__}, got {value!r}")
    return value

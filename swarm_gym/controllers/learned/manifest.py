"""Checks of a policy's manifest: every entry that is used later is checked before any is used.

Entries that are not named here are allowed: they document where a policy comes from.
"""

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, NamedTuple, NotRequired, TypedDict, cast

from swarm_gym.action import ACTIONS
from swarm_gym.controllers.names import ControllerName
from swarm_gym.errors import UnknownNameError, shown
from swarm_gym.observation import OBSERVATIONS, make_observation
from swarm_gym.optimizers import ALL_OPTIMIZERS, OPTIMIZERS
from swarm_gym.own_code import was_given

# Far beyond the networks trained here (two layers of 64), and so small that products of them stay cheap.
MAX_WIDTH = 4096
MAX_LAYERS = 16
MAX_TEXT = 1000  # characters of a name
MAX_FEATURES = 1000
MAX_NUMBER = 10**9

FEEDFORWARD, LSTM, CHOICES = "feedforward", "lstm", "choices"
PRICED = "priced"  # observation layout with the price


class PolicyFileError(ValueError):
    """A policy file that is missing, damaged or not for this version; the message names the file."""


class Manifest(TypedDict):
    """The checked entries of a policy's manifest, and further entries that trainings write.

    `check_manifest` says what each of the checked entries can be.
    """

    action: str
    base: str
    config: dict[str, object]
    corrected_from: int
    features: list[str]
    hidden_layers: list[int]
    initial_population_size: int
    lstm_size: int | None
    manifest_sha256: str
    max_evaluations: int | None
    max_population_size: int
    min_population_size: int
    network: str
    num_decisions: int
    observation: str
    optimizer: str
    price: list[float] | None
    weights_sha256: str
    also_on: NotRequired[list[str]]
    first_source: NotRequired[dict[str, object]]
    num_choices: NotRequired[int]
    steps: NotRequired[int]
    validation: NotRequired[dict[str, dict[str, float]]]


class _Entry(NamedTuple):
    """A condition on a value, in words and as a test that takes any JSON value."""

    expected: str
    fits: Callable[[Any], bool]


def check_manifest(path: Path, content: Mapping[str, object]) -> Manifest:
    """Return the content of a manifest, if it has all entries and no unusable value.

    Raises:
        PolicyFileError: naming the file, the entry, its value and what was expected.
    """
    missing = [key for key in _REQUIRED if key not in content]
    if missing:
        raise PolicyFileError(f"{path}: the manifest lacks {', '.join(missing)}")
    for key, entry in _REQUIRED.items():
        _require(path, content, key, entry)
    manifest = cast(Manifest, content)
    smallest, largest = manifest["min_population_size"], manifest["max_population_size"]
    _require(path, manifest, "max_population_size", _integer(smallest))
    _require(path, manifest, "initial_population_size", _integer(smallest, largest))
    if manifest["max_evaluations"] is not None:
        _require(path, manifest, "max_evaluations", _integer(manifest["initial_population_size"]))
    if manifest["network"] == LSTM:
        _require(path, manifest, "lstm_size", _integer(1, MAX_WIDTH))
    if manifest["network"] == CHOICES:
        _require(path, manifest, "num_choices", _integer(1, MAX_WIDTH))
    if observes_price(manifest):
        _require(path, manifest, "price", _PRICES)
    if "also_on" in manifest:
        _require(path, manifest, "also_on", _OPTIMIZERS)
    if manifest["base"] == "none":
        own = [feature.name for feature in make_observation(manifest["observation"]).features]
        require_features(path, manifest, own)
    return manifest


def observes_price(manifest: Manifest) -> bool:
    """Return whether the price of evaluations is among the policy's observations."""
    return PRICED in manifest["observation"].split("+")


def require_features(path: Path, manifest: Manifest, features: list[str]) -> None:
    """Raise an error if a policy was trained with other observation features than these.

    Raises:
        PolicyFileError: naming both lists of features.
    """
    if manifest["features"] != features:
        raise PolicyFileError(
            f"{path}: trained with observation features {shown(manifest['features'])}, but "
            f"{shown(manifest['observation'])} with base {shown(manifest['base'])} has {features}"
        )


def tensor_shapes(manifest: Manifest) -> dict[str, tuple[int, ...]]:
    """Return the shape of every tensor in the policy's file by name; weights are (outputs, inputs)."""
    inputs = len(manifest["features"])
    shapes: dict[str, tuple[int, ...]] = {}
    if manifest["network"] == LSTM:
        size = manifest["lstm_size"] or 0  # which is checked
        shapes["lstm.weight"], shapes["lstm.bias"] = (4 * size, inputs + size), (4 * size,)
        inputs = size
    last = manifest["num_decisions"]
    if manifest["network"] == CHOICES:
        last = manifest["num_choices"]
        shapes["choices"] = (last, manifest["num_decisions"])
    for number, outputs in enumerate([*manifest["hidden_layers"], last]):
        shapes[f"{number}.weight"], shapes[f"{number}.bias"] = (outputs, inputs), (outputs,)
        inputs = outputs
    return shapes


def _require(path: Path, manifest: Mapping[str, object], key: str, entry: _Entry) -> None:
    value = manifest.get(key)
    if not entry.fits(value):
        raise PolicyFileError(f"{path}: {key} must be {entry.expected}, got {shown(value)}")


def _integer(low: int, high: int = MAX_NUMBER) -> _Entry:
    # A bool is no integer here.
    return _Entry(
        f"an integer from {low} to {high}", lambda value: type(value) is int and low <= value <= high
    )


def _one_of(*names: str, code: bool = False) -> _Entry:
    """Return an entry with one of these names, or of own code that was named outside of files."""
    more = ", or own code that you allow with swarm_gym.own_code" if code else ""
    return _Entry(
        f"one of {', '.join(sorted(names))}{more}",
        lambda value: isinstance(value, str) and (value in names or (code and was_given(value))),
    )


def _optional(entry: _Entry) -> _Entry:
    return _Entry(f"{entry.expected}, or null", lambda value: value is None or entry.fits(value))


def _is_text(value: object) -> bool:
    return isinstance(value, str) and 0 < len(value) <= MAX_TEXT and value.isprintable()


def _is_observation(value: object) -> bool:
    try:
        if not isinstance(value, str) or len(value) > MAX_TEXT:
            return False
        # A name in a file never imports code.
        known = all(part in OBSERVATIONS or was_given(part) for part in value.split("+"))
        return known and bool(make_observation(value).features)
    except UnknownNameError:
        return False


def _is_base(value: object) -> bool:
    # The scaled decisions of another policy cannot be corrected, and files could name each other for ever.
    return isinstance(value, str) and _is_text(value) and ControllerName.parse(value).family != "learned"


def _is_prices(value: object) -> bool:
    if not isinstance(value, list) or len(value) not in (1, 2):
        return False
    numbers = all(type(number) in (int, float) and 0 <= number <= MAX_NUMBER for number in value)
    return numbers and value == sorted(value)


_SIZES = _Entry(
    f"a list of at most {MAX_LAYERS} integers from 1 to {MAX_WIDTH}",
    lambda value: (
        isinstance(value, list)
        and len(value) <= MAX_LAYERS
        and all(_integer(1, MAX_WIDTH).fits(size) for size in value)
    ),
)
_FEATURES = _Entry(
    f"a list of 1 to {MAX_FEATURES} names",
    lambda value: isinstance(value, list) and 0 < len(value) <= MAX_FEATURES and all(map(_is_text, value)),
)
_PRICES = _Entry(
    f"a list of positive numbers up to {MAX_NUMBER:g}, one or (low, high)",
    lambda value: _is_prices(value) and value[0] > 0,
)
_OPTIMIZERS = _Entry(
    f"a list of names, each one of {', '.join(sorted(OPTIMIZERS))}",
    lambda value: isinstance(value, list) and all(_one_of(*OPTIMIZERS, code=True).fits(v) for v in value),
)
_DIGEST = _Entry(
    "a digest of 64 hexadecimal digits",
    lambda value: isinstance(value, str) and len(value) == 64 and not set(value) - set("0123456789abcdef"),
)
_REQUIRED = {
    # Outputs of a network lie in [-1, 1].
    "action": _one_of(*(name for name, layout in ACTIONS.items() if layout.size != "natural"), code=True),
    "base": _Entry("'none' or the name of a controller that is no policy itself", _is_base),
    "config": _Entry("a table of options", lambda value: isinstance(value, dict)),
    "corrected_from": _integer(0),
    "features": _FEATURES,
    "hidden_layers": _SIZES,
    "initial_population_size": _integer(1),
    "lstm_size": _optional(_integer(1, MAX_WIDTH)),
    "manifest_sha256": _DIGEST,
    "max_evaluations": _optional(_integer(1)),
    "max_population_size": _integer(1),
    "min_population_size": _integer(1),
    "network": _one_of(FEEDFORWARD, LSTM, CHOICES),
    "num_decisions": _integer(1, MAX_WIDTH),
    "observation": _Entry("an observation layout, or several joined by +", _is_observation),
    "optimizer": _one_of(*ALL_OPTIMIZERS, code=True),
    "price": _optional(_Entry("a list of one or two numbers in order", _is_prices)),
    "weights_sha256": _DIGEST,
}

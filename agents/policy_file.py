"""Trained policies on disk: weights as safetensors, with a JSON manifest in the file's header.

Reading one runs no code. The manifest says what the policy expects and where it comes from.
"""

import hashlib
import json
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from safetensors import SafetensorError, safe_open
from safetensors.numpy import save

from agents.shipped import find_file, shipped_names
from swarm_gym.files import write_atomically

FORMAT = "swarm_gym policy 1"
POLICIES = Path(__file__).parent / "policies"
SUFFIX = ".safetensors"

Weights = dict[str, NDArray[np.float32]]

REQUIRED = (
    "action",
    "base",
    "features",
    "hidden_layers",
    "initial_population_size",
    "max_population_size",
    "min_population_size",
    "num_decisions",
    "observation",
    "optimizer",
    "weights_sha256",
)


class PolicyFileError(ValueError):
    """A policy file is missing, damaged, or not for this version; the message names the file."""


def shipped_policies() -> list[str]:
    """Names of the policies that come with the project; of those in folders, `<folder>/<file>`."""
    return shipped_names(POLICIES, SUFFIX)


def resolve(name: str) -> Path:
    """The file of a shipped policy by name, or the path that was given.

    Raises:
        PolicyFileError: if neither exists.
    """
    path = find_file(name, POLICIES, SUFFIX)
    if path is not None:
        return path
    split = [shipped.rpartition("/") for shipped in shipped_policies()]
    forms = sorted({f"{folder}/<seed>" if folder else file for folder, _, file in split})
    raise PolicyFileError(
        f"policy {name!r}: neither a shipped policy ({', '.join(forms) or 'none'}) nor a file"
    )


def save_policy(path: Path, weights: Weights, manifest: dict[str, Any]) -> None:
    """Write weights and manifest in one file, at once or not at all."""
    manifest = {**manifest, "format": FORMAT, "weights_sha256": _digest(weights)}
    header = {"manifest": json.dumps(manifest, sort_keys=True)}
    contiguous = {name: np.ascontiguousarray(array) for name, array in weights.items()}
    write_atomically(path, save(contiguous, metadata=header))


def load_policy(path: Path) -> tuple[Weights, dict[str, Any]]:
    """Weights and manifest of a policy file.

    Raises:
        PolicyFileError: if the file is damaged, incomplete or of another format.
    """
    try:
        with safe_open(path, framework="numpy") as file:
            header = file.metadata() or {}
            weights = {name: file.get_tensor(name) for name in file.keys()}  # noqa: SIM118
        manifest = json.loads(header.get("manifest", "{}"))
    except (OSError, SafetensorError, json.JSONDecodeError) as error:
        raise PolicyFileError(f"{path}: not a readable policy file ({error})") from error
    if not isinstance(manifest, dict) or manifest.get("format") != FORMAT:
        raise PolicyFileError(f"{path}: expected format {FORMAT!r}, got {_get_format(manifest)!r}")
    missing = [key for key in REQUIRED if key not in manifest]
    if missing:
        raise PolicyFileError(f"{path}: the manifest lacks {', '.join(missing)}")
    if manifest["weights_sha256"] != _digest(weights):
        raise PolicyFileError(f"{path}: the weights do not match their digest in the manifest")
    return weights, manifest


def _get_format(manifest: object) -> object:
    return manifest.get("format") if isinstance(manifest, dict) else manifest


def _digest(weights: Weights) -> str:
    digest = hashlib.sha256()
    for name in sorted(weights):
        digest.update(f"{name} {weights[name].dtype} {weights[name].shape}".encode())
        digest.update(np.ascontiguousarray(weights[name]).tobytes())
    return digest.hexdigest()

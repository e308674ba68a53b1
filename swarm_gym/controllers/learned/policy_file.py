"""Trained policies on disk: weights as safetensors, with a JSON manifest in the file's header.

Reading a policy runs no code. The manifest states what the policy expects and where it comes from. Reading
any file takes little time and memory; it returns a policy that can decide, or raises an error that names the
fault. Digests detect damage, not malice: whoever changes a file can write new digests.
"""

import hashlib
import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from safetensors import SafetensorError
from safetensors.numpy import load, save

from swarm_gym.controllers.learned.manifest import Manifest, PolicyFileError, check_manifest, tensor_shapes
from swarm_gym.controllers.packaged import DATA, Packaged, read_bytes
from swarm_gym.errors import shown
from swarm_gym.files import write_atomically

__all__ = ["PolicyFileError", "Weights", "decode_policy", "encode_policy", "load_policy", "save_policy"]

FORMAT = "swarm_gym policy 1"
POLICIES = Packaged(DATA / "policies", ".safetensors")

Weights = dict[str, NDArray[np.float32]]

# Bytes. Two hidden layers of 1024 need a quarter of this. Packaged files have up to 48 kB, of which 4 kB are
# the header with the manifest and the places of the tensors.
MAX_FILE = 2**24
ZIP = b"PK\x03\x04"  # how zip files begin
MAX_HEADER = 2**20
# Training does not find larger weights; with these no sum of a network comes near the end of float32.
MAX_WEIGHT = 1e6


def packaged_policies() -> list[str]:
    """Return the names of the policies in the package, e.g. `three-cases/0`."""
    return POLICIES.names()


def policies_of(recipe: str) -> list[str]:
    """Return the names of the packaged policies of a recipe, one for each training seed."""
    return [name for name in packaged_policies() if name.startswith(f"{recipe}/")]


def resolve(name: str) -> Path:
    """Return the file of a packaged policy by its name, or the given path if it is a file.

    Raises:
        PolicyFileError: if neither exists.
    """
    path = POLICIES.find(name)
    if path is not None:
        return path
    raise PolicyFileError(POLICIES.missing("policy", name))


def save_policy(path: Path, weights: Weights, manifest: Mapping[str, object]) -> None:
    """Write weights and manifest to one file, atomically."""
    write_atomically(path, encode_policy(weights, manifest))


def load_policy(path: Path) -> tuple[Weights, Manifest]:
    """Return weights and manifest of a policy file.

    Raises:
        PolicyFileError: if the file is damaged, incomplete, too large or of another format.
    """
    try:
        data = read_bytes(path, MAX_FILE)
    except (OSError, ValueError) as error:
        raise PolicyFileError(f"{path}: not a readable policy file ({error})") from error
    return decode_policy(path, data)


def encode_policy(weights: Weights, manifest: Mapping[str, object]) -> bytes:
    """Return the content of a policy file, with digests of the weights and of the rest of the manifest."""
    stated = {**manifest, "format": FORMAT, "weights_sha256": _digest_of_weights(weights)}
    stated["manifest_sha256"] = _digest_of_manifest(stated)
    header = {"manifest": json.dumps(stated, sort_keys=True)}
    contiguous = {name: np.ascontiguousarray(array) for name, array in weights.items()}
    return save(contiguous, metadata=header)


def decode_policy(path: Path, data: bytes) -> tuple[Weights, Manifest]:
    """Return weights and manifest from the content of a policy file; the path is for messages.

    No tensor is read before its name, type and shape are those that the manifest implies.

    Raises:
        PolicyFileError: if the file is damaged, incomplete or of another format.
    """
    if data.startswith(ZIP):
        raise PolicyFileError(
            f"{path}: this is a zip, as stable-baselines3 stores models; convert it first by "
            f"`python -m agents.import_sb3 {path} policy.safetensors`"
        )
    try:
        header = _read_header(data)
        content = json.loads(header.pop("__metadata__", {}).get("manifest", "{}"))
        if not isinstance(content, dict) or content.get("format") != FORMAT:
            raise PolicyFileError(f"{path}: expected format {FORMAT!r}, got {shown(_get_format(content))}")
        manifest = check_manifest(path, content)
        declared = {name: (entry.get("dtype"), entry.get("shape")) for name, entry in header.items()}
        expected = {name: ("F32", list(shape)) for name, shape in tensor_shapes(manifest).items()}
        _require_tensors(path, declared, expected)
        weights = load(data)
        # Checked again after reading: two readers may disagree about a name that is given twice.
        found = {name: (str(array.dtype), list(array.shape)) for name, array in weights.items()}
        _require_tensors(path, found, {name: ("float32", shape) for name, (_, shape) in expected.items()})
        digests = {
            "weights_sha256": _digest_of_weights(weights),
            "manifest_sha256": _digest_of_manifest(manifest),
        }
    except PolicyFileError:
        raise
    # JSON that is nested too deeply raises RecursionError; a header of other types raises the rest.
    except (SafetensorError, ValueError, TypeError, AttributeError, RecursionError) as error:
        raise PolicyFileError(f"{path}: not a readable policy file ({_shown(error)})") from error
    for name, array in weights.items():
        if not (np.abs(array) <= MAX_WEIGHT).all():
            raise PolicyFileError(f"{path}: tensor {name}: expected finite numbers up to {MAX_WEIGHT:g}")
    if manifest["weights_sha256"] != digests["weights_sha256"]:
        raise PolicyFileError(f"{path}: the weights do not match their digest in the manifest")
    if manifest["manifest_sha256"] != digests["manifest_sha256"]:
        raise PolicyFileError(
            f"{path}: the manifest does not match its own digest: it was changed afterwards"
        )
    return weights, manifest


def _read_header(data: bytes) -> dict[str, Any]:
    """Return the JSON object that follows its length, 8 bytes, at the start of a safetensors file."""
    length = int.from_bytes(data[:8], "little")
    if len(data) < 8 or not 2 <= length <= min(MAX_HEADER, len(data) - 8):
        raise ValueError(
            f"expected a header of up to {MAX_HEADER} bytes, and as many in the file, which has {len(data)}; "
            f"it announces {length}"
        )
    header = json.loads(data[8 : 8 + length])
    if not isinstance(header, dict):
        raise ValueError(f"expected a header with names, got {shown(header)}")
    return header


def _require_tensors(path: Path, found: Mapping[str, object], expected: Mapping[str, object]) -> None:
    for name in [*expected, *found]:
        if found.get(name) != expected.get(name):
            says, wanted = found.get(name, "none"), expected.get(name, "none")
            raise PolicyFileError(
                f"{path}: tensor {shown(name)}: expected {wanted} by the manifest, got {shown(says)}"
            )


def _get_format(manifest: object) -> object:
    return manifest.get("format") if isinstance(manifest, dict) else manifest


def _digest_of_weights(weights: Weights) -> str:
    digest = hashlib.sha256()
    for name in sorted(weights):
        digest.update(f"{name} {weights[name].dtype} {weights[name].shape}".encode())
        digest.update(np.ascontiguousarray(weights[name]).tobytes())
    return digest.hexdigest()


def _digest_of_manifest(manifest: Mapping[str, object]) -> str:
    """Return the digest of all other entries, as JSON with sorted keys."""
    rest = {name: value for name, value in manifest.items() if name != "manifest_sha256"}
    return hashlib.sha256(json.dumps(rest, sort_keys=True).encode()).hexdigest()


def _shown(error: Exception) -> str:
    text = str(error) or type(error).__name__
    return text if len(text) <= 200 else text[:200] + "..."

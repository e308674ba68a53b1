"""Trained policies on disk: weights as safetensors, with a JSON manifest in the file's header.

Reading one runs no code. The manifest says what the policy expects and where it comes from. Whatever is in a
file, reading it takes little time and memory, and gives a policy that can decide, or an error that says what
is wrong. Digests tell damage, not malice: who changes a file can write new ones.
"""

import hashlib
import json
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from safetensors import SafetensorError
from safetensors.numpy import load, save

from swarm_gym.controllers.learned.manifest import PolicyFileError, check_manifest, tensor_shapes
from swarm_gym.controllers.packaged import find_file, read_bytes, shipped_names
from swarm_gym.errors import shown
from swarm_gym.files import write_atomically

__all__ = ["PolicyFileError", "Weights", "decode_policy", "encode_policy", "load_policy", "save_policy"]

FORMAT = "swarm_gym policy 1"
POLICIES = Path(__file__).parents[1] / "data" / "policies"
SUFFIX = ".safetensors"

Weights = dict[str, NDArray[np.float32]]

# Bytes. Two hidden layers of 1024 need a quarter of this, what ships has up to 48 kB; 3 kB
# of that are the header, which is the manifest and where tensors are.
MAX_FILE = 2**24
MAX_HEADER = 2**20
# Larger ones are not found by training; with these no sum of a network comes near the end of float32.
MAX_WEIGHT = 1e6


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
        f"policy {shown(name)}: neither a shipped policy ({', '.join(forms) or 'none'}) nor a file"
    )


def save_policy(path: Path, weights: Weights, manifest: dict[str, Any]) -> None:
    """Write weights and manifest in one file, at once or not at all."""
    write_atomically(path, encode_policy(weights, manifest))


def load_policy(path: Path) -> tuple[Weights, dict[str, Any]]:
    """Weights and manifest of a policy file.

    Raises:
        PolicyFileError: if the file is damaged, incomplete, too large or of another format.
    """
    try:
        data = read_bytes(path, MAX_FILE)
    except (OSError, ValueError) as error:
        raise PolicyFileError(f"{path}: not a readable policy file ({error})") from error
    return decode_policy(path, data)


def encode_policy(weights: Weights, manifest: dict[str, Any]) -> bytes:
    """The content of a policy file, with digests of the weights and of all else that the manifest says."""
    manifest = {**manifest, "format": FORMAT, "weights_sha256": _digest_of_weights(weights)}
    manifest["manifest_sha256"] = _digest_of_manifest(manifest)
    header = {"manifest": json.dumps(manifest, sort_keys=True)}
    contiguous = {name: np.ascontiguousarray(array) for name, array in weights.items()}
    return save(contiguous, metadata=header)


def decode_policy(path: Path, data: bytes) -> tuple[Weights, dict[str, Any]]:
    """Weights and manifest that the content of a policy file has; the path is for messages.

    No tensor is looked at before its name, type and shape are those that the manifest implies.

    Raises:
        PolicyFileError: if the file is damaged, incomplete or of another format.
    """
    try:
        header = _read_header(data)
        manifest = json.loads(header.pop("__metadata__", {}).get("manifest", "{}"))
        if not isinstance(manifest, dict) or manifest.get("format") != FORMAT:
            raise PolicyFileError(f"{path}: expected format {FORMAT!r}, got {shown(_get_format(manifest))}")
        check_manifest(path, manifest)
        declared = {name: (entry.get("dtype"), entry.get("shape")) for name, entry in header.items()}
        expected = {name: ("F32", list(shape)) for name, shape in tensor_shapes(manifest).items()}
        _require_tensors(path, declared, expected)
        weights = load(data)
        # Once more of what was read: of a name that is given twice, two readers may take different ones.
        found = {name: (str(array.dtype), list(array.shape)) for name, array in weights.items()}
        _require_tensors(path, found, {name: ("float32", shape) for name, (_, shape) in expected.items()})
        digests = {
            "weights_sha256": _digest_of_weights(weights),
            "manifest_sha256": _digest_of_manifest(manifest),
        }
    except PolicyFileError:
        raise
    # JSON that is nested too deeply is a RecursionError; a header of other types than JSON objects the rest.
    except (SafetensorError, ValueError, TypeError, AttributeError, RecursionError) as error:
        raise PolicyFileError(f"{path}: not a readable policy file ({_shown(error)})") from error
    for name, array in weights.items():
        if not (np.abs(array) <= MAX_WEIGHT).all():
            raise PolicyFileError(f"{path}: tensor {name}: expected finite numbers up to {MAX_WEIGHT:g}")
    if manifest["weights_sha256"] != digests["weights_sha256"]:
        raise PolicyFileError(f"{path}: the weights do not match their digest in the manifest")
    # The first files lack it.
    if manifest.get("manifest_sha256", digests["manifest_sha256"]) != digests["manifest_sha256"]:
        raise PolicyFileError(
            f"{path}: the manifest does not match its own digest: it was changed afterwards"
        )
    return weights, manifest


def _read_header(data: bytes) -> dict[str, Any]:
    """The JSON object that a safetensors file begins with, after its length in 8 bytes."""
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


def _require_tensors(path: Path, found: dict[str, Any], expected: dict[str, Any]) -> None:
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


def _digest_of_manifest(manifest: dict[str, Any]) -> str:
    """Of all entries but the digest itself, as JSON with sorted keys."""
    rest = {name: value for name, value in manifest.items() if name != "manifest_sha256"}
    return hashlib.sha256(json.dumps(rest, sort_keys=True).encode()).hexdigest()


def _shown(error: Exception) -> str:
    text = str(error) or type(error).__name__
    return text if len(text) <= 200 else text[:200] + "..."

"""Files that appear under their name only when they are complete; where the package keeps its own."""

import hashlib
import os
import threading
from contextlib import suppress
from pathlib import Path

import platformdirs

PARTIAL = ".partial"


def write_atomically(path: Path, content: bytes | str, before: Path | None = None) -> Path:
    """Write a file, text as UTF-8, at once or not at all; makes its folder; returns the path.

    It is on the disk when this returns, so that neither a killed process nor a power failure leaves a part
    of it. Several processes may write the same file: the last one wins. A process that is killed here may
    leave a file `*.partial`, see `remove_partials`.

    Args:
        path: the file.
        content: all of it.
        before: what the file becomes that is there already; at every moment one of the two is whole.

    Raises:
        OSError: naming the file, if it cannot be written; what was there is still there.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    partial = path.with_name(f"{path.name}.{os.getpid()}-{threading.get_ident()}{PARTIAL}")
    try:
        with partial.open("wb") as file:
            file.write(content.encode() if isinstance(content, str) else content)
            file.flush()
            os.fsync(file.fileno())
        if before is not None and path.exists():
            os.replace(path, before)
        os.replace(partial, path)
        _synchronise(path.parent)
    except BaseException as error:
        with suppress(OSError):
            partial.unlink(missing_ok=True)
        if isinstance(error, OSError):  # that a disk is full is said without a name
            raise OSError(error.errno, error.strerror, str(path)) from error
        raise
    return path


def remove_partials(folder: Path) -> None:
    """Remove what processes that were killed while they wrote left in a folder; none may write to it now."""
    for partial in folder.glob(f"*{PARTIAL}"):
        partial.unlink(missing_ok=True)


def _synchronise(folder: Path) -> None:
    """Have the names in a folder on the disk, too, where a folder can be opened: not on Windows."""
    try:
        descriptor = os.open(folder, os.O_RDONLY)
    except OSError:
        return
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def user_cache() -> Path:
    """Folder for what can be computed again: `SWARM_GYM_CACHE` where that is set, else the user's cache."""
    return Path(os.environ.get("SWARM_GYM_CACHE") or platformdirs.user_cache_dir("swarm_gym"))


def digest_of_sources(place: Path) -> str:
    """Return a digest of a Python file, or of all in a folder and below, as 16 hexadecimal digits."""
    digest = hashlib.sha256()
    for source in [place] if place.is_file() else sorted(place.rglob("*.py")):
        digest.update(str(source.relative_to(place.parent)).encode())
        digest.update(source.read_bytes())
    return digest.hexdigest()[:16]

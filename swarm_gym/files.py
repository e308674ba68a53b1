"""Files that are written completely or not at all, and the folder of the package's own files."""

import hashlib
import os
import threading
from contextlib import suppress
from pathlib import Path

import platformdirs

PARTIAL = ".partial"


def write_atomically(path: Path, content: bytes | str, before: Path | None = None) -> Path:
    """Write a file at once or not at all, text as UTF-8; make its folder; return its path.

    The file is on the disk when this function returns, so neither a killed process nor a power failure leaves
    a part of it. If several processes write the same file, the last one wins. A process that is killed here
    may leave a file `*.partial`, see `remove_partials`.

    Args:
        path: path of the file.
        content: complete content.
        before: new path of the file that is replaced, if there is one. At every moment one of the two files
            is complete.

    Raises:
        OSError: naming the file, if it cannot be written; the previous file is still there.
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
        if isinstance(error, OSError):  # the operating system reports a full disk without naming the file
            raise OSError(error.errno, error.strerror, str(path)) from error
        raise
    return path


def remove_partials(folder: Path) -> None:
    """Remove the partial files that killed processes left in a folder; no process may write to it now."""
    for partial in folder.glob(f"*{PARTIAL}"):
        partial.unlink(missing_ok=True)


def _synchronise(folder: Path) -> None:
    """Write the names in a folder to the disk where a folder can be opened, which Windows does not allow."""
    try:
        descriptor = os.open(folder, os.O_RDONLY)
    except OSError:
        return
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def user_cache() -> Path:
    """Return the folder of files that can be computed again.

    It is `SWARM_GYM_CACHE` if that is set, else a folder in the user's cache.
    """
    return Path(os.environ.get("SWARM_GYM_CACHE") or platformdirs.user_cache_dir("swarm_gym"))


def digest_of_sources(place: Path) -> str:
    """Return a digest of a Python file, or of all Python files below a folder, as 16 hexadecimal digits."""
    digest = hashlib.sha256()
    for source in [place] if place.is_file() else sorted(place.rglob("*.py")):
        digest.update(str(source.relative_to(place.parent)).encode())
        digest.update(source.read_bytes())
    return digest.hexdigest()[:16]

"""Files that are written completely or not at all, and the folder of the package's own files."""

import errno
import hashlib
import os
import threading
import time
from contextlib import suppress
from pathlib import Path

import platformdirs

PARTIAL = ".partial"
REFUSES_OPEN_FILES = os.name == "nt"  # whether the system refuses to replace a file that is open
REPLACE_TIMEOUT = 1.0  # seconds


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
            _replace(path, before)
        _replace(partial, path)
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


def _replace(source: Path, target: Path) -> None:
    """Rename a file; where the system refuses it while another program reads the target, try for a second.

    Linux and macOS replace a file that is open. Windows does not, and there virus scanners open new files.
    """
    last = time.monotonic() + REPLACE_TIMEOUT
    while True:
        try:
            os.replace(source, target)
        except PermissionError:
            if not REFUSES_OPEN_FILES or time.monotonic() > last:
                raise
            time.sleep(0.02)
        else:
            return


def _synchronise(folder: Path) -> None:
    """Write the names in a folder to the disk where the system can do so.

    Windows does not open folders, and some file systems, such as network drives, refuse to synchronise them.
    """
    try:
        descriptor = os.open(folder, os.O_RDONLY)
    except OSError:
        return
    try:
        os.fsync(descriptor)
    except OSError as error:
        if error.errno not in (errno.EBADF, errno.EINVAL, errno.ENOTSUP):
            raise
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
    # By parts: Windows has other separators, and sorts without regard to capital letters.
    for source in [place] if place.is_file() else sorted(place.rglob("*.py"), key=lambda path: path.parts):
        digest.update(source.relative_to(place.parent).as_posix().encode())
        digest.update(source.read_bytes())
    return digest.hexdigest()[:16]

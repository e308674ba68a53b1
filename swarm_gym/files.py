"""Files that appear under their name only when they are complete; where the package keeps its own."""

import hashlib
import os
import threading
from pathlib import Path

import platformdirs


def write_atomically(path: Path, content: bytes | str) -> Path:
    """Write a file, text as UTF-8, at once or not at all; makes its folder; returns the path.

    Several processes may write the same file: the last one wins.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    partial = path.with_name(f"{path.name}.{os.getpid()}-{threading.get_ident()}.partial")
    partial.write_bytes(content.encode() if isinstance(content, str) else content)
    os.replace(partial, path)
    return path


def user_cache() -> Path:
    """Folder for what can be computed again: `SWARM_GYM_CACHE` where that is set, else the user's cache."""
    return Path(os.environ.get("SWARM_GYM_CACHE") or platformdirs.user_cache_dir("swarm_gym"))


def digest_of_sources(folder: Path, *more: str) -> str:
    """A digest of all Python files of a folder and below, and of some texts; 16 hexadecimal digits."""
    digest = hashlib.sha256("".join(more).encode())
    for source in sorted(folder.rglob("*.py")):
        digest.update(str(source.relative_to(folder)).encode())
        digest.update(source.read_bytes())
    return digest.hexdigest()[:16]

"""Names of files that a plan or a flight is written to: endings, and what else can be wrong with them."""

from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import TypeVar

from swarm_gym.errors import SettingError

Made = TypeVar("Made")


def format_of(path: Path, formats: Mapping[str, Made]) -> Made:
    """Return the entry of the ending of a file's name.

    Args:
        path: file to write.
        formats: function that makes the content of a file, by the ending of its name.

    Raises:
        SettingError: for an ending that is not in `formats`.
    """
    if path.suffix not in formats:
        raise SettingError(f"output {str(path)!r}: the name must end with {', '.join(formats)}")
    return formats[path.suffix]


def checked(paths: Iterable[Path], formats: Mapping[str, object]) -> Iterator[Path]:
    """Yield each name of a file that can be written, so that the caller can check more of it.

    Args:
        paths: files to write.
        formats: function that makes the content of a file, by the ending of its name.

    Raises:
        SettingError: for an ending that is not in `formats`, a folder, or a name that is given twice.
    """
    seen = set()
    for path in paths:
        format_of(path, formats)
        if path.is_dir():
            raise SettingError(f"output {str(path)!r}: a folder; name a file in it")
        yield path
        if path in seen:
            raise SettingError(f"output {str(path)!r}: given twice; name each file once")
        seen.add(path)

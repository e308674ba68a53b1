"""Files that a command is asked to write: names are checked before any work, so that no input is lost."""

import os
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path

from swarm_gym.errors import SettingError


def require_outputs(
    paths: Iterable[Path], read: Iterable[object] = (), formats: Mapping[str, object] | None = None
) -> None:
    """Raise an error unless files of these names can be written.

    Args:
        paths: files to write.
        read: inputs of the command; those that are paths of files must stay, see `files_named`.
        formats: endings that names may have, as keys; by default any.

    Raises:
        SettingError: for another ending, a folder, a name below a file or in a folder that cannot be written,
            a name of two outputs, or a file that is read.
    """
    kept = {Path(one).resolve() for one in read if isinstance(one, str | Path) and os.path.isfile(one)}
    seen: set[Path] = set()
    for path in paths:
        if formats is not None and path.suffix not in formats:
            raise SettingError(f"output {str(path)!r}: the name must end with {', '.join(formats)}")
        if path.is_dir():
            raise SettingError(f"output {str(path)!r}: a folder; name a file in it")
        above = next(one for one in path.absolute().parents if one.exists())
        if not above.is_dir():
            raise SettingError(f"output {str(path)!r}: {str(above)!r} is a file, no folder for it")
        if not os.access(above, os.W_OK | os.X_OK):
            raise SettingError(f"output {str(path)!r}: the folder {str(above)!r} cannot be written")
        if path.resolve() in kept:
            raise SettingError(f"output {str(path)!r}: this command reads it; name another file")
        if path.resolve() in seen:
            raise SettingError(f"output {str(path)!r}: two outputs have this name; name each file once")
        seen.add(path.resolve())


def files_named(*names: object) -> list[Path]:
    """Return the files that are there and that names such as `learned:mine.safetensors@1` contain.

    Args:
        names: names of controllers and scenarios, with paths of files in them or without; objects have none.
    """
    texts = [str(name) for name in names if isinstance(name, str | Path)]
    return [Path(part) for text in texts for part in parts_of(text) if os.path.isfile(part)]


def parts_of(name: str) -> Iterator[str]:
    """Yield the parts of a name that can be a path: from its start or a sign on, to another sign or its end.

    Signs are those in names of controllers and scenarios, such as `firefly+learned:mine/a.safetensors@0.3`
    and `ros:mine/b.yaml?start=0,0&goal=1,1`.
    """
    begins = [0, *(k + 1 for k, sign in enumerate(name) if sign in ":=+")]
    ends = [len(name), *(k for k, sign in enumerate(name) if sign in "?&@,")]
    yield from (name[begin:end] for begin in begins for end in ends if begin < end)

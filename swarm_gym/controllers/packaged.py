"""Files of the package and of the laboratory, found by name, and files of a user, found by path.

The laboratory is the package `experiments` of a checkout of the repository. It lies next to this package, and
is found there, not imported; an installed wheel has none. It has policies, open loops, tuned controllers and
presets of studies, in `experiments/studies/<study>/data/<kind>`. `data/studies.json` has the study of each
recipe. With it, an error says where a recipe is kept.
"""

import json
import os
from dataclasses import dataclass
from pathlib import Path

from swarm_gym.controllers.names import ControllerName
from swarm_gym.errors import listed, shown

# Largest size of text files of controllers and presets, in bytes; the largest packaged one has 51 kB.
MAX_TEXT_FILE = 2**20
DATA = Path(__file__).parent / "data"
LABORATORY = Path(__file__).parents[2] / "experiments"
INDEX = DATA / "studies.json"
WITHOUT_LABORATORY = (
    "belongs to the laboratory, which is not part of the installed package. Install a checkout of the "
    "repository instead, with pip install --editable"
)


@dataclass(frozen=True)
class Packaged:
    """Files of a kind that have names, e.g. policies: first in the package, then in the laboratory.

    Args:
        folder: folder in the package; its name is the kind, which folders of studies have, too.
        suffix: suffix of the files.
    """

    folder: Path
    suffix: str

    @property
    def kind(self) -> str:
        """Name of the folders with these files."""
        return self.folder.name

    @property
    def folders(self) -> list[Path]:
        """Folder in the package, and the folders of all studies where the laboratory is there."""
        return [self.folder, *study_folders(self.kind)]

    def names(self) -> list[str]:
        """Return the sorted names of all files, relative to their folder and without the suffix."""
        files = [path.relative_to(one) for one in self.folders for path in one.rglob(f"*{self.suffix}")]
        return sorted(file.as_posix().removesuffix(self.suffix) for file in files)

    def find(self, name: str) -> Path | None:
        """Return the file of that name, else the file at that path, else None."""
        for path in (*(folder / f"{name}{self.suffix}" for folder in self.folders), Path(name)):
            if os.path.isfile(path):  # unlike `Path.is_file`, this takes any name
                return path
        return None

    def missing(self, what: str, name: str) -> str:
        """Return the message of an error: there is no file of that name, nor at that path.

        Args:
            what: kind of the file, e.g. `open loop`.
            name: name that was asked for.
        """
        recipe = ControllerName.of("tuned", name).recipe or name
        if elsewhere := where_it_lives(self.kind, recipe):
            return f"{what} {shown(name)} {elsewhere}"
        groups: dict[str, list[str]] = {}
        for known in self.names():
            # One entry for several training seeds of a recipe: a/*@1 for a/0@1, a/1@1 and so on.
            groups.setdefault(ControllerName.of("tuned", known).group.argument, []).append(known)
        forms = [group if len(members) > 1 else members[0] for group, members in groups.items()]
        packaged = listed(forms, name, str(self.folder)) or "none"
        return f"{what} {shown(name)}: neither a packaged one ({packaged}) nor a file"


def read_bytes(path: Path, limit: int) -> bytes:
    """Return the content of a regular file of at most `limit` bytes.

    Raises:
        OSError: if it cannot be read, or is no regular file: a device could have no end.
        ValueError: if it has more bytes.
    """
    if not os.path.isfile(path):
        raise OSError("not a regular file" if os.path.exists(path) else "no such file")
    with path.open("rb") as file:
        data = file.read(limit + 1)
    if len(data) > limit:
        raise ValueError(f"expected at most {limit} bytes, the file has more")
    return data


def find_json(what: str, name: str, files: Packaged, error: type[ValueError]) -> Path:
    """Return the JSON file of that name, else the file at that path.

    Raises:
        ValueError: an instance of `error`, if neither exists; the message lists the packaged files.
    """
    path = files.find(name)
    if path is None:
        raise error(files.missing(what, name))
    return path


def read_json(path: Path, form: str) -> dict[str, object]:
    """Return the content of a JSON file, an object whose entry `format` has to be `form`.

    Raises:
        OSError, KeyError, TypeError, ValueError: if it is not readable, or of another format.
    """
    try:
        content = json.loads(read_bytes(path, MAX_TEXT_FILE).decode())
    except RecursionError as error:
        raise ValueError("it is nested too deeply") from error
    if content["format"] != form:
        raise ValueError(f"expected format {form!r}, got {shown(content['format'])}")
    return content


def has_laboratory() -> bool:
    """Return whether the package comes from a checkout, with the laboratory next to it."""
    return (LABORATORY / "studies").is_dir()


def study_folders(kind: str) -> list[Path]:
    """Return the folders of studies with files of a kind, e.g. `policies`; none without the laboratory."""
    return sorted(LABORATORY.glob(f"studies/*/data/{kind}"))


def where_it_lives(kind: str, recipe: str) -> str:
    """Return what an error says of a missing file: that a checkout has that recipe, and in which folder.

    Returns:
        The empty text where the laboratory was searched, and for a recipe that it does not have.
    """
    index: dict[str, dict[str, str]] = json.loads(INDEX.read_text(encoding="utf-8"))
    study = index.get(kind, {}).get(recipe)
    if study is None or has_laboratory():
        return ""
    return f"{WITHOUT_LABORATORY}, or give the path of a file in experiments/studies/{study}/data/{kind}"

"""Files of the laboratory, which no wheel has: policies, open loops, tuned controllers, presets of studies.

A checkout of the repository keeps them in `experiments/studies/<study>/data/<kind>`. They are found by name
wherever the package `experiments` can be imported, e.g. in the root of a checkout. It is located, not
imported. `data/studies.json` has the study of each recipe. With it, an error says where a recipe is kept.
"""

import json
from importlib.util import find_spec
from pathlib import Path

LABORATORY = "experiments"
INDEX = Path(__file__).parent / "data" / "studies.json"


def study_folders(kind: str) -> list[Path]:
    """Return the folders of all studies with files of a kind, e.g. `policies`; none without the laboratory."""
    studies = _studies()
    return sorted(studies.glob(f"*/data/{kind}")) if studies else []


def where_it_lives(kind: str, recipe: str) -> str:
    """Return the end of an error message on a missing file: where the laboratory keeps that recipe.

    Returns:
        The empty text where the laboratory was found and searched, and for a recipe that it does not have.
    """
    study = None if _studies() else _index().get(kind, {}).get(recipe)
    if study is None:
        return ""
    return (
        f"; it belongs to the laboratory, which is not part of the installed package: see {LABORATORY}/"
        f"studies/{study}/data/{kind} in a checkout of the repository. Run from the root of the checkout, or "
        f"give the path of the file"
    )


def _index() -> dict[str, dict[str, str]]:
    """Return the study of each recipe, by kind."""
    return json.loads(INDEX.read_text(encoding="utf-8"))


def _studies() -> Path | None:
    """Return the folder of all studies, or None if the laboratory cannot be imported."""
    try:
        found = find_spec(LABORATORY)
    except ValueError:  # a module of that name that no importer has made
        return None
    if found is None or found.origin is None:  # None is a folder of that name that is no package
        return None
    folder = Path(found.origin).parent / "studies"
    return folder if folder.is_dir() else None

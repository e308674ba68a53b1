"""Files of the laboratory, which no wheel has: policies, open loops, tuned controllers, presets of studies.

The laboratory is the package `experiments` of a checkout of the repository. It lies beside this package, and
is found there, not imported; an installed wheel has none. Its files are in
`experiments/studies/<study>/data/<kind>`. `data/studies.json` has the study of each recipe. With it, an error
says where a recipe is kept.
"""

import json
from pathlib import Path

LABORATORY = Path(__file__).parents[2] / "experiments"
INDEX = Path(__file__).parent / "data" / "studies.json"
WITHOUT = (
    "belongs to the laboratory, which is not part of the installed package. Install a checkout of the "
    "repository instead, with pip install --editable"
)


def has_laboratory() -> bool:
    """Return whether the package comes from a checkout, with the laboratory beside it."""
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
    return f"{WITHOUT}, or give the path of a file in experiments/studies/{study}/data/{kind}"

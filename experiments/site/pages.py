"""All pages of the site that are generated from the code, and where they stand below `docs`."""

from pathlib import Path

from experiments.site import animations
from experiments.site.commands import commands_page
from experiments.site.documents import copied_documents
from experiments.site.environments import environment_page, index_page
from experiments.site.reference import reference_pages
from experiments.site.registries import REGISTRIES
from swarm_gym.files import write_atomically
from swarm_gym.optimizers import OPTIMIZERS

ENVIRONMENTS, REFERENCE = "environments", "reference"

REFERENCE_INDEX = """\
# Reference

These pages list every public name with its arguments, shapes, units and errors. They are made from the code
of this version.

```{{toctree}}
:caption: Names to choose from
:maxdepth: 1

{registries}
commands
```

```{{toctree}}
:caption: Python
:maxdepth: 1

{modules}
```
"""


def generated_pages(root: Path) -> dict[str, str]:
    """Return the text of all generated pages, by path below `docs`.

    Args:
        root: root of the repository, which has the documents, and `scores` if there are reference scores.
    """
    scores = root / "scores"
    pages = {
        f"{ENVIRONMENTS}/{name}.md": environment_page(
            name, animations.SCENARIO, animations.CONTROLLER, scores if scores.is_dir() else None
        )
        for name in OPTIMIZERS
    }
    pages[f"{ENVIRONMENTS}/index.md"] = index_page()
    modules = reference_pages()
    pages |= {f"{REFERENCE}/{name}.rst": text for name, text in modules.items()}
    pages |= {f"{REFERENCE}/{name}.md": make() for name, make in REGISTRIES.items()}
    pages[f"{REFERENCE}/commands.md"] = commands_page()
    pages[f"{REFERENCE}/index.md"] = REFERENCE_INDEX.format(
        registries="\n".join(REGISTRIES), modules="\n".join(modules)
    )
    return pages | copied_documents(root)


def write_pages(docs: Path) -> None:
    """Write all generated pages and animations below the folder `docs`; pages of former versions go.

    A page that is the same stays as it is, so that Sphinx does not read it again.

    Raises:
        OSError: if a file cannot be written.
        MissingExtraError: if a library of the extra `video` is missing.
    """
    pages = generated_pages(docs.parent)
    for folder in (ENVIRONMENTS, REFERENCE):
        for old in (docs / folder).glob("*.*"):
            if old.is_file() and f"{folder}/{old.name}" not in pages:
                old.unlink()
    for name, text in pages.items():
        path = docs / name
        if not path.is_file() or path.read_text(encoding="utf-8") != text:
            write_atomically(path, text)
    for name in OPTIMIZERS:
        animations.write_animation(name, docs / ENVIRONMENTS / "animations" / f"{name}.gif")

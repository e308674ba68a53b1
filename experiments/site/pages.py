"""All pages of the site that are generated from the code, and where they stand below `docs`.

Documents of the repository outside of `docs` are copied there, with links that lead to pages of the site.
Each environment has an animation, a short GIF file of the map alone.
"""

import posixpath
import re
from contextlib import closing
from pathlib import Path

from agents import make_controller
from experiments.gallery import map_environment, map_of
from experiments.plots.video_files import GifFile
from experiments.site import reference
from experiments.site.commands import commands_page
from experiments.site.environments import environment_page, index_page
from experiments.site.reference import reference_pages
from experiments.site.registries import REGISTRIES
from experiments.video import film
from swarm_gym.files import write_atomically
from swarm_gym.optimizers import ALL_OPTIMIZERS, SPECIAL_OPTIMIZERS

ENVIRONMENTS, REFERENCE = "environments", "reference"

# Few members: their lines are what makes a file large.
SCENARIO, CONTROLLER, SEED, ITERATIONS = "case2", "fixed:10", 0, 40
# Width and height of the map in pixels, without the margins around it; pictures per second.
SIZE, FPS = (260, 156), 8

# By document outside of `docs`, its page on the site. The README has the role of the first page.
PAGES = {"README.md": "index.md", "CONTRIBUTING.md": "contributing.md", "CHANGELOG.md": "changelog.md"}
COPIED = ("CONTRIBUTING.md", "CHANGELOG.md")
DOCS = "docs"

_LINK = re.compile(r"\[([^\[\]]*)\]\(([^()\s:#]+)(#[^()\s]*)?\)")
_FENCE = re.compile(r"(^```.*?^```$)", re.MULTILINE | re.DOTALL)

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
            name, SCENARIO, CONTROLLER, scores if scores.is_dir() else None
        )
        for name in ALL_OPTIMIZERS
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
    for name in ALL_OPTIMIZERS:
        write_animation(name, docs / ENVIRONMENTS / "animations" / f"{name}.gif")


def on_site(text: str, document: str, root: Path) -> str:
    """Return a document with links that work on the site.

    Links to documents with a page lead to that page. Links to modules of the reference become references to
    them; it shows their source. A folder has no page: its link becomes text. All other links stay, and Sphinx
    copies the files that they lead to.

    Args:
        text: text of the document.
        document: path of the document below the root, with slashes, such as `docs/guide.md`.
        root: root of the repository.
    """
    page = posixpath.relpath(PAGES[document] if document in PAGES else document.removeprefix(f"{DOCS}/"))

    modules = {module for each in reference.PAGES.values() for module in each.modules}

    def replaced(link: re.Match[str]) -> str:
        label, target, anchor = link[1], link[2], link[3] or ""
        path = posixpath.normpath(posixpath.join(posixpath.dirname(document), target))
        if (root / path).is_dir():
            return label
        if not (root / path).is_file():
            return link[0]
        module = path.removesuffix(".py").removesuffix("/__init__").replace("/", ".")
        if path.endswith(".py") and module in modules:
            return f"{{py:mod}}`{label.strip('`')} <{module}>`"
        place = PAGES.get(path, path.removeprefix(f"{DOCS}/") if path.startswith(f"{DOCS}/") else None)
        if place is None:  # the file itself, which Sphinx copies; its path is that from the page
            place = posixpath.join("..", path)
        return f"[{label}]({posixpath.relpath(place, posixpath.dirname(page) or '.')}{anchor})"

    parts = _FENCE.split(text)
    return "".join(part if part.startswith("```") else _LINK.sub(replaced, part) for part in parts)


def copied_documents(root: Path) -> dict[str, str]:
    """Return the pages of the documents outside of `docs`, by the name of their file there."""
    return {PAGES[name]: on_site((root / name).read_text(encoding="utf-8"), name, root) for name in COPIED}


def write_animation(optimizer: str, path: Path) -> None:
    """Film a short episode of an optimizer's environment into a GIF file.

    Raises:
        OSError: if the file cannot be written.
        MissingExtraError: if a library of the extra `video` is missing.
    """
    controller = make_controller(CONTROLLER)
    options = {} if optimizer in SPECIAL_OPTIMIZERS else {"scenario": SCENARIO}
    env = map_environment(optimizer, controller, SIZE, iterations=ITERATIONS, **options)
    with closing(env), GifFile(path, FPS) as file:
        for picture in film(env, controller, SEED):
            file.add(map_of(picture, SIZE))

"""Documents of the repository on the site: copies of those outside of `docs`, and links that lead there."""

import posixpath
import re
from pathlib import Path

from experiments.site import reference

# By document outside of `docs`, its page on the site. The README has the role of the first page.
PAGES = {"README.md": "index.md", "CONTRIBUTING.md": "contributing.md", "CHANGELOG.md": "changelog.md"}
COPIED = ("CONTRIBUTING.md", "CHANGELOG.md")
DOCS = "docs"

_LINK = re.compile(r"\[([^\[\]]*)\]\(([^()\s:#]+)(#[^()\s]*)?\)")
_FENCE = re.compile(r"(^```.*?^```$)", re.MULTILINE | re.DOTALL)


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

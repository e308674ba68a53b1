"""Check all internal links of a built site: `python -m experiments.site.check_links FOLDER`.

A link leads to a file of the site, and its anchor to an element of that page with this id. The command prints
how many links it checked, and every broken one.
"""

import argparse
from collections.abc import Iterator
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

from swarm_gym.command import command

# By element, the attributes that name a file.
LINKS = {
    "a": ("href",), "area": ("href",), "link": ("href",), "img": ("src",), "script": ("src",),
    "iframe": ("src",), "source": ("src",), "video": ("src", "poster"), "object": ("data",),
}  # fmt: skip


class BrokenLinksError(ValueError):
    """A built site with broken links; the message lists them."""


class LinkedPage(HTMLParser):
    """The links of an HTML page, and the anchors that others can lead to.

    Attributes:
        links: targets as they stand in the page.
        anchors: ids of elements, and names of `a` elements.
    """

    def __init__(self, text: str) -> None:
        super().__init__()
        self.links: list[str] = []
        self.anchors: set[str] = set()
        self.feed(text)
        self.close()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Add the links and anchors of an element."""
        given = {name: value or "" for name, value in attrs}
        self.links += [given[name] for name in LINKS.get(tag, ()) if given.get(name)]
        self.anchors |= {given[name] for name in ("id", "name") if given.get(name)}


def check_links(site: Path) -> int:
    """Return the number of internal links of a site, all of which lead somewhere.

    Raises:
        BrokenLinksError: if some do not, or there is no page.
    """
    pages = {
        path.resolve(): LinkedPage(path.read_text(encoding="utf-8")) for path in sorted(site.rglob("*.html"))
    }
    if not pages:
        raise BrokenLinksError(f"{site}: expected a built site, found no HTML page; run `make docs`")
    number, broken = 0, []
    for path, page in pages.items():
        for link in page.links:
            if not _is_internal(link):
                continue
            number += 1
            broken += [
                f"{path.relative_to(site.resolve()).as_posix()}: {fault}"
                for fault in _faults(link, path, pages, site)
            ]
    if broken:
        listed = "\n".join(dict.fromkeys(broken))
        raise BrokenLinksError(f"{len(broken)} of {number} internal links are broken:\n{listed}")
    return number


def _is_internal(link: str) -> bool:
    parts = urlsplit(link)
    return not parts.scheme and not parts.netloc


def _faults(link: str, path: Path, pages: dict[Path, LinkedPage], site: Path) -> Iterator[str]:
    """Yield what is wrong with a link of the page at a path."""
    parts = urlsplit(link)
    names = {parts.fragment, unquote(parts.fragment)}
    target = (path.parent / unquote(parts.path)).resolve() if parts.path else path
    if target.is_dir():
        target /= "index.html"
    if not target.is_relative_to(site.resolve()):
        yield f"{link} leads out of the site"
    elif not target.is_file():
        yield f"{link} leads to no file"
    elif parts.fragment and target in pages and not names & pages[target].anchors:
        yield f"{link} leads to no element of that page"


def main() -> None:
    """Check the site in the folder that the command line names."""
    parser = argparse.ArgumentParser(prog="python -m experiments.site.check_links", description=__doc__)
    parser.add_argument("folder", type=Path, metavar="FOLDER", help="the built site")
    folder = parser.parse_args().folder
    with command(BrokenLinksError):
        number = check_links(folder)
        pages = len(list(folder.rglob("*.html")))
    print(f"{number:,} internal links of {pages} pages lead somewhere")


if __name__ == "__main__":
    main()

"""Put a suite's results into its document: `python -m experiments.publish_suite SUITE_FOLDER DOCUMENT`.

Fills the marked blocks of the document from the tables of the suite's page, by their names, and copies its
SVG figures to docs/results/<suite>, which then has no others: no number there is typed by hand. The blocks of
a collection are named <suite>/<table>.
"""

import sys
from pathlib import Path

from experiments.documents.blocks import block_names, replace_block
from swarm_gym.command import command
from swarm_gym.files import write_atomically


def publish_suite(folder: Path, document: Path) -> None:
    """Fill the blocks and copy the figures.

    Raises:
        OSError: if a table or the document is missing.
    """
    text = document.read_text(encoding="utf-8")
    for name in block_names(text):
        text = replace_block(text, name, (folder / f"{name}.md").read_text(encoding="utf-8"))
    figures = document.parent / "results" / folder.name
    shown = {file.name: file.read_bytes() for file in sorted(folder.rglob("*.svg"))}
    for name, content in shown.items():
        write_atomically(figures / name, content)
    for path in figures.glob("*.svg"):
        if path.name not in shown:
            path.unlink()
    write_atomically(document, text)


def main() -> None:
    """Publish what the command line names."""
    if len(sys.argv) != 3:
        sys.exit("usage: python -m experiments.publish_suite SUITE_FOLDER DOCUMENT")
    with command():
        publish_suite(Path(sys.argv[1]), Path(sys.argv[2]))


if __name__ == "__main__":
    main()

"""Put the study's results into its document: `python -m experiments.publish_study FOLDER`.

Fills the marked blocks of docs/study.md from the tables that the suites and the analyses wrote to folders of
their names in FOLDER, and copies the figures that it shows to docs/results/study, which then has
no others: no number there is typed by hand. Where something is missing, nothing is written.
"""

import sys
from pathlib import Path

from experiments.documents.blocks import block_names, replace_block
from experiments.studies.learned.blocks import BLOCKS, FIGURES, Source
from swarm_gym.command import command
from swarm_gym.files import write_atomically

STUDY = Path("docs/study.md")


def publish_study(folder: Path) -> None:
    """Fill the blocks and copy the figures.

    Raises:
        OSError: if a table or figure is missing, or the document.
        ValueError: if a block is missing or unknown, or a table is not as expected.
    """
    text = STUDY.read_text(encoding="utf-8")
    unknown = sorted(set(block_names(text)) - set(BLOCKS))
    if unknown:
        raise ValueError(f"{STUDY}: nothing is known of the blocks {', '.join(unknown)}")
    source = Source(folder)
    for name, make in BLOCKS.items():
        text = replace_block(text, name, make(source))
    figures = STUDY.parent / FIGURES
    for name, content in source.figures.items():
        write_atomically(figures / name, content)
    write_atomically(STUDY, text)
    for path in figures.glob("*.svg"):
        if path.name not in source.figures:
            path.unlink()


def main() -> None:
    """Publish what the command line names."""
    if len(sys.argv) != 2:
        sys.exit("usage: python -m experiments.publish_study FOLDER")
    with command():
        publish_study(Path(sys.argv[1]))


if __name__ == "__main__":
    main()

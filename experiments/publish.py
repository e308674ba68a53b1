"""Put results into the documents: `python -m experiments.publish SUITE_FOLDER BENCHMARK_FOLDER`.

Copies a suite's page and the SVG figures to docs/results, and replaces the marked blocks of README.md and
docs/performance.md by the suite's summary and the benchmark's tables: no number there is typed by hand.
"""

import shutil
import sys
from pathlib import Path

from experiments.documents.blocks import replace_block
from experiments.speed.page import CAPTIONS, headline, read_folder, table
from swarm_gym.command import command
from swarm_gym.files import write_atomically

DOCS = Path("docs/results")
README = Path("README.md")
PERFORMANCE = Path("docs/performance.md")


def publish(suite: Path, benchmark: Path) -> None:
    """Copy page and figures, and fill the blocks of both documents.

    Raises:
        OSError: if something is missing.
        ValueError: if a block or a group of the benchmark is missing.
    """
    machine, groups = read_folder(benchmark)
    missing = set(CAPTIONS) - set(groups)
    if missing:
        raise ValueError(f"{benchmark}: {', '.join(sorted(missing))} was not measured")
    speed = headline(machine, groups).markdown()
    readme = README.read_text(encoding="utf-8")
    readme = replace_block(readme, "results", (suite / "summary.md").read_text(encoding="utf-8"))
    readme = replace_block(readme, "speed", speed)
    performance = replace_block(PERFORMANCE.read_text(encoding="utf-8"), "headline", speed)
    for name, measurements in groups.items():
        performance = replace_block(performance, name, table(name, measurements).markdown())
    DOCS.mkdir(parents=True, exist_ok=True)
    for file in (suite / "README.md", *sorted(suite.glob("*.svg")), benchmark / "growth.svg"):
        shutil.copyfile(file, DOCS / file.name)
    write_atomically(README, readme)
    write_atomically(PERFORMANCE, performance)


def main() -> None:
    """Publish what the command line names."""
    if len(sys.argv) != 3:
        sys.exit("usage: python -m experiments.publish SUITE_FOLDER BENCHMARK_FOLDER")
    with command():
        publish(Path(sys.argv[1]), Path(sys.argv[2]))


if __name__ == "__main__":
    main()

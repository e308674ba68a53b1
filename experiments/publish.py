"""Put results into the documents: `python -m experiments.publish SUITE_FOLDER BENCHMARK_TABLE`.

Copies a suite's page and its SVG figures to docs/results, and replaces the marked blocks of README.md by the
suite's summary and the benchmark's table, so that no number there is typed by hand.
"""

import re
import shutil
import sys
from pathlib import Path

from swarm_gym.files import write_atomically

DOCS = Path("docs/results")
README = Path("README.md")


def replace_block(text: str, name: str, content: str) -> str:
    """The text with what stands between `<!-- name -->` and `<!-- /name -->` replaced.

    Raises:
        ValueError: if there is no such block.
    """
    block = re.compile(rf"(<!-- {name} -->\n).*?(<!-- /{name} -->)", re.DOTALL)
    if not block.search(text):
        raise ValueError(f"{README} has no block {name!r}")
    return block.sub(lambda match: f"{match[1]}{content.strip()}\n{match[2]}", text)


def publish(suite: Path, benchmark: Path) -> None:
    """Copy page and figures of a suite, and fill the blocks of the README."""
    text = README.read_text(encoding="utf-8")
    text = replace_block(text, "results", (suite / "summary.md").read_text(encoding="utf-8"))
    text = replace_block(text, "speed", benchmark.read_text(encoding="utf-8"))
    DOCS.mkdir(parents=True, exist_ok=True)
    for file in (suite / "README.md", *sorted(suite.glob("*.svg"))):
        shutil.copyfile(file, DOCS / file.name)
    write_atomically(README, text)


def main() -> None:
    """Publish what the command line names."""
    if len(sys.argv) != 3:
        sys.exit("usage: python -m experiments.publish SUITE_FOLDER BENCHMARK_TABLE")
    try:
        publish(Path(sys.argv[1]), Path(sys.argv[2]))
    except (OSError, ValueError) as error:
        sys.exit(f"error: {error}")


if __name__ == "__main__":
    main()

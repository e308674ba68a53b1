"""One page with all tables and figures of a suite, and the tables as files of their own."""

from collections.abc import Sequence
from pathlib import Path

from experiments.suites import SUITES, Suite
from experiments.tables import Table
from swarm_gym.files import write_atomically


def write_page(suite: Suite, tables: Sequence[Table], figures: Sequence[Path], folder: Path) -> Path:
    """Write every table as Markdown, CSV and LaTeX, and a README.md that shows all; returns the latter."""
    for table in tables:
        for suffix, text in (("md", table.markdown()), ("csv", table.csv()), ("tex", table.latex())):
            write_atomically(folder / f"{table.name}.{suffix}", text)
    pictures = [
        f"![{figure.stem.replace('-', ' ')}]({figure.name})\n"
        for figure in figures
        if figure.suffix == ".svg"
    ]
    seeds = "seed" if suite.num_seeds == 1 else "seeds"
    parts = [
        f"# Suite {suite.name}: {suite.num_seeds} {seeds} per controller and scenario\n",
        f"Made by `{_command(suite)}`.\n",
        *(table.markdown() for table in tables),
        *pictures,
    ]
    return write_atomically(folder / "README.md", "\n".join(parts))


def _command(suite: Suite) -> str:
    command = f"python -m experiments.evaluate --suite {suite.name} --seeds {suite.num_seeds}"
    usual = SUITES.get(suite.name, suite).controllers
    return command if suite.controllers == usual else f"{command} --controllers {' '.join(suite.controllers)}"

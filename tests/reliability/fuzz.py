"""Fuzz the parsers of files, guided by the lines that they reach: `make fuzz SECONDS=3600`.

Some inputs make a parser raise an undocumented error, run for more than 5 s or take more than 200 MiB at
once. They are kept in fuzz_finds/<parser> beside this file. From then on test_fuzz_finds.py tries them.

Source: Atheris, https://github.com/google/atheris, which tells libFuzzer which lines of Python are reached.
"""

import argparse
import subprocess
import sys
import tempfile
from pathlib import Path

FINDS = Path(__file__).parent / "fuzz_finds"
INSTRUMENTED = [
    "agents",
    "json",
    "PIL",
    "safetensors",
    "swarm_gym.errors",
    "swarm_gym.observation",
    "swarm_gym.planning",
    "swarm_gym.scenarios",
    "tomllib",
    "yaml",
]
TIMEOUT, MAX_MEMORY = 5, 200  # seconds, MiB
MAX_LENGTH = 1 << 14


def fuzz(name: str, seconds: int, corpus: Path, folder: Path) -> None:
    """Fuzz one parser in this process, which then ends; the folder is for the files of the parser."""
    import atheris

    atheris.enabled_hooks.add("str")
    with atheris.instrument_imports(include=INSTRUMENTED, enable_loader_override=False):
        from helpers import parsers
    parser = parsers.PARSERS[name]
    seeds = parser.seeds()
    for number, content in enumerate(seeds):
        (corpus / f"seed{number}").write_bytes(content)
    (folder / "words").write_text("\n".join(map(_quoted, parser.words)) + "\n")
    FINDS.joinpath(name).mkdir(parents=True, exist_ok=True)
    atheris.Setup(
        [
            sys.argv[0],
            f"-max_total_time={seconds}",
            f"-max_len={max(MAX_LENGTH, *map(len, seeds))}",
            f"-timeout={TIMEOUT}",
            f"-malloc_limit_mb={MAX_MEMORY}",
            f"-artifact_prefix={FINDS / name}/",
            f"-dict={folder / 'words'}",
            "-use_value_profile=1",
            "-print_final_stats=1",
            "-verbosity=0",
            str(corpus),
        ],
        lambda content: parsers.parse(name, content, folder),
    )
    atheris.Fuzz()


def main() -> None:
    """Fuzz all parsers, or the named ones, each for the same time."""
    from helpers.parsers import PARSERS

    cli = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    cli.add_argument(
        "parsers", nargs="*", metavar="PARSER", help=f"some of {', '.join(PARSERS)}; all without"
    )
    cli.add_argument("--seconds", type=int, default=3600, help="for all together")
    cli.add_argument(
        "--corpus",
        type=Path,
        default=Path("results/fuzz"),
        help="folder of inputs that reach new lines; kept",
    )
    arguments = cli.parse_args()
    names = arguments.parsers or list(PARSERS)
    unknown = sorted(set(names) - set(PARSERS))
    if unknown:
        cli.error(f"unknown parser {unknown[0]!r}, expected some of {', '.join(PARSERS)}")
    found = []
    for name in names:
        corpus = arguments.corpus / name
        corpus.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(prefix="fuzz", dir=_fast_folder()) as folder:
            values = [name, str(arguments.seconds // len(names)), str(corpus.resolve()), folder]
            command = [sys.executable, "-c", _ONE, *values]
            done = subprocess.run(command, capture_output=True, text=True, check=False)
        stats = dict(
            line.removeprefix("stat::").split(": ")
            for line in done.stderr.splitlines()
            if line.startswith("stat::")
        )
        executed = stats.get("number_of_executed_units", "?").strip()
        print(f"{name}: {executed} inputs, {len(list(corpus.iterdir()))} kept", flush=True)
        if done.returncode:
            found.append(name)
            print(done.stderr[-3000:], file=sys.stderr, flush=True)
    sys.exit(f"finds of {', '.join(found)}, see {FINDS}" if found else 0)


_ONE = """
import pathlib, sys, fuzz
fuzz.fuzz(sys.argv[1], int(sys.argv[2]), *map(pathlib.Path, sys.argv[3:]))
"""


def _quoted(word: str) -> str:
    """Return a line of libFuzzer's dictionaries."""
    return '"' + "".join(f"\\x{byte:02x}" for byte in word.encode("utf-8", "surrogatepass")) + '"'


def _fast_folder() -> str | None:
    """Return a folder in memory if there is one."""
    memory = Path("/dev/shm")
    return str(memory) if memory.is_dir() else None


if __name__ == "__main__":
    main()

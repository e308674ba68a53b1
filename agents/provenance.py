"""What a result was made with."""

import subprocess
from importlib.metadata import version
from pathlib import Path

import swarm_gym


def provenance(*packages: str) -> dict[str, str]:
    """Versions of swarm_gym and of these packages, and the commit of the checkout."""
    return {
        "commit": git_commit(),
        "swarm_gym": swarm_gym.__version__,
        **{package: version(package) for package in packages},
    }


def git_commit() -> str:
    """The commit of the checkout, marked where files were changed since; "unknown" outside of one."""
    command = ["git", "describe", "--always", "--dirty", "--abbrev=40"]
    folder = Path(__file__).parent
    try:
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=True)
    except (OSError, subprocess.CalledProcessError):
        return "unknown"
    return done.stdout.strip()

"""What a result was made with."""

import os
import subprocess
from importlib.metadata import version
from pathlib import Path

import swarm_gym

COMMIT = "SWARM_GYM_COMMIT"  # the variable that names it to workers which have the sources alone


def provenance(*packages: str) -> dict[str, str]:
    """Versions of swarm_gym and of these packages, and the commit of the checkout."""
    return {
        "commit": git_commit(),
        "swarm_gym": swarm_gym.__version__,
        **{package: version(package) for package in packages},
    }


def git_commit() -> str:
    """The commit of the checkout, marked where files were changed since; "unknown" outside of one."""
    if told := os.environ.get(COMMIT):
        return told
    command = ["git", "describe", "--always", "--dirty", "--abbrev=40"]
    folder = Path(__file__).parent
    try:
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=True)
    except (OSError, subprocess.CalledProcessError):
        return "unknown"
    return done.stdout.strip()

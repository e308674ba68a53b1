"""Provenance of results: versions of packages and the commit of the checkout."""

import os
import subprocess
from importlib.metadata import version
from pathlib import Path

import swarm_gym

COMMIT = "SWARM_GYM_COMMIT"  # environment variable with the commit, for workers without the repository


def provenance(*packages: str) -> dict[str, str]:
    """Return the versions of swarm_gym and of these packages, and the commit of the checkout."""
    return {
        "commit": git_commit(),
        "swarm_gym": swarm_gym.__version__,
        **{package: version(package) for package in packages},
    }


def git_commit() -> str:
    """Return the commit of the checkout, with a mark if files were changed since; "unknown" without one.

    An installed package may lie inside somebody else's repository, which does not track its files.
    """
    if commit := os.environ.get(COMMIT):
        return commit
    try:
        _git("ls-files", "--error-unmatch", Path(__file__).name)
        return _git("describe", "--always", "--dirty", "--abbrev=40")
    except (OSError, subprocess.CalledProcessError):
        return "unknown"


def _git(*arguments: str) -> str:
    folder = Path(__file__).parent
    done = subprocess.run(["git", *arguments], cwd=folder, capture_output=True, text=True, check=True)
    return done.stdout.strip()

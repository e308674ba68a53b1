"""The commit that results state is that of the repository which tracks the package."""

import subprocess

import pytest

from swarm_gym.runs import provenance


@pytest.fixture
def repository(tmp_path, monkeypatch):
    """Return a function that runs git in somebody's repository, in which the package lies."""
    monkeypatch.delenv(provenance.COMMIT, raising=False)
    monkeypatch.setattr(provenance, "__file__", str(tmp_path / "provenance.py"))
    (tmp_path / "provenance.py").write_text("")

    def git(*arguments):
        who = ("-c", "user.name=a", "-c", "user.email=a@b")
        done = subprocess.run(
            ["git", *who, *arguments], cwd=tmp_path, check=True, capture_output=True, text=True
        )
        return done.stdout.strip()

    git("init", "-q")
    git("commit", "-q", "--allow-empty", "-m", "theirs")
    return git


def test_a_package_installed_inside_somebody_elses_repository_has_no_commit(repository):
    assert provenance.git_commit() == "unknown"


def test_a_package_that_its_repository_tracks_has_the_commit_and_a_mark_of_changes(repository, tmp_path):
    repository("add", "provenance.py")
    repository("commit", "-q", "-m", "ours")
    assert provenance.git_commit() == repository("rev-parse", "HEAD")
    (tmp_path / "provenance.py").write_text("changed")
    assert provenance.git_commit() == f"{repository('rev-parse', 'HEAD')}-dirty"

"""The page of layouts lists every layout and reward, as they are now."""

from pathlib import Path

import pytest

pytest.importorskip("tyro", reason="needs the extra `study`")

from experiments.documents.marked_blocks import fill
from experiments.publish import DOCUMENTS
from experiments.site.layouts import ACTIONS_ARE_FOR, OBSERVATIONS_ARE_FOR
from swarm_gym.action import ACTIONS
from swarm_gym.observation import OBSERVATIONS


def test_the_page_of_layouts_is_current(monkeypatch):
    monkeypatch.chdir(Path(__file__).parents[3])
    (document,) = DOCUMENTS["layouts"]
    filled = fill(document, Path("results"))
    assert filled.text == document.path.read_text(encoding="utf-8"), "run `make docs-layouts`"


def test_every_layout_says_whom_it_is_for():
    assert set(ACTIONS_ARE_FOR) == set(ACTIONS)
    assert set(OBSERVATIONS_ARE_FOR) == set(OBSERVATIONS)

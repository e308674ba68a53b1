"""The gallery shows every optimizer on every kind of map, and the document that ships is up to date."""

from pathlib import Path

import numpy as np
import pytest

from experiments import gallery
from experiments.gallery import (
    DOCUMENT,
    HEIGHT,
    OPTIONS,
    PICTURES,
    WIDTH,
    Panel,
    document,
    picture,
    plan,
)
from swarm_gym.optimizers import OPTIMIZERS
from swarm_gym.rendering import pen
from swarm_gym.scenarios import FAMILIES, make_scenario

image = pytest.importorskip("PIL.Image")
pytest.importorskip("pygame")

ROOT = Path(__file__).parents[3]


@pytest.fixture(scope="module")
def rows():
    return plan()


def test_the_plan_has_every_optimizer_on_a_map_of_every_family_without_files(rows):
    assert [row[0].optimizer for row in rows] == list(OPTIMIZERS)
    for row in rows:
        assert {panel.optimizer for panel in row} == {row[0].optimizer}
        families = [panel.scenario.partition(":")[0] for panel in row[1:]]
        assert families == [name for name, family in FAMILIES.items() if family.samples]


def test_only_what_the_library_refuses_is_missing(rows):
    refused = {(panel.optimizer, panel.scenario) for row in rows for panel in row if panel.refusal}
    function = next(name for name in gallery.scenarios() if name.startswith("function:"))
    assert refused == {(name, function) for name in ("glowworm", "ant-colony")}


def test_the_document_that_ships_is_that_of_the_registries(rows):
    assert (ROOT / DOCUMENT).read_text(encoding="utf-8") == document(rows), "run `make docs-gallery`"


def test_the_pictures_that_ship_are_those_of_the_document_and_small(rows):
    expected = {panel.file for row in rows for panel in row if not panel.refusal}
    files = list((ROOT / PICTURES).glob("*"))
    assert {file.name for file in files} == expected
    for file in files:
        with image.open(file) as opened:
            assert opened.size == (WIDTH, HEIGHT)
    assert sum(file.stat().st_size for file in files) < 1.5e6


def test_a_new_optimizer_and_a_new_family_appear_by_themselves(monkeypatch):
    monkeypatch.setitem(gallery.OPTIMIZERS, "twin", OPTIMIZERS["firefly"])
    monkeypatch.setitem(gallery.FAMILIES, "more", FAMILIES["rooms"])
    monkeypatch.setattr(gallery, "_panel", lambda *names: Panel(*names, refusal="not now"))
    rows = plan()
    assert rows[-1][0].optimizer == "twin"
    assert len(rows[0]) == len(gallery.scenarios())
    text = document(rows)
    assert "| `twin` | – (1) |" in text
    assert text.count("\n1. not now\n") == 1
    assert "\n2. " not in text


def test_a_picture_is_the_map_alone_the_same_every_time():
    panel = Panel("firefly", "case2", OPTIONS[-1])
    first, second = picture(panel), picture(panel)
    np.testing.assert_array_equal(first, second)
    assert first.shape == (HEIGHT, WIDTH, 3)
    for colour in (pen.START, pen.TARGET, pen.BEST):
        assert (np.abs(first.astype(int) - colour).max(axis=-1) < 40).any()
    # The map of the case is wider than the picture: its frame goes from the left to the right.
    faint = np.abs(first[:, [0, 1, -2, -1]].astype(int) - pen.FAINT_INK).max(axis=-1) < 60
    assert faint.any(axis=0)[[0, 1]].any()
    assert faint.any(axis=0)[[2, 3]].any()


def test_where_something_happens_the_picture_is_made_after_it():
    for name in FAMILIES["dynamic"].samples:
        scenario = make_scenario(name)
        if scenario.events:
            assert Panel("firefly", name).iterations > max(event.iteration for event in scenario.events)

"""The pictures of planned paths: what they show, and that those which ship show it."""

import re
from pathlib import Path

import pytest

pytest.importorskip("tyro", reason="needs the extra `study`")

from experiments.plans import PICTURES, PIXELS, alternatives

SHIPPED = Path(__file__).parents[3] / "docs/results/plans"


def labels(picture):
    """Return the texts of an SVG file of Matplotlib, which writes them as comments beside their outlines."""
    return re.findall(r"<!-- (.*) -->", picture)


def test_a_picture_has_a_line_for_each_corridor_with_its_length():
    found = labels(alternatives().decode())
    assert [text for text in found if "length" in text] == [
        "path 1: length 1,054", "path 2: length 1,055", "path 3: length 1,072"
    ]  # fmt: skip
    assert {"S", "T", "x", "y"} <= set(found)
    assert labels((SHIPPED / "alternatives.svg").read_text(encoding="utf-8")) == found


def test_all_pictures_ship_and_are_small():
    assert {path.name for path in SHIPPED.iterdir()} == set(PICTURES)
    assert max(path.stat().st_size for path in SHIPPED.iterdir()) < 300_000


def test_the_shipped_curve_has_both_robots():
    texts = [text for text in labels((SHIPPED / "curve.svg").read_text(encoding="utf-8")) if "length" in text]
    assert [text.partition(":")[0] for text in texts] == ["turns on the spot", "turning radius 2"]


def test_the_shipped_flight_is_as_wide_as_it_should_be():
    image = pytest.importorskip("PIL.Image")
    assert image.open(SHIPPED / "flight.png").width == PIXELS

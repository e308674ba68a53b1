"""Measured numbers in the prose of pages stand in a generated block of the page or of its appendix.

The prose is what lies outside of generated blocks and code. A number is looked at if it has a decimal point,
a comma or a per cent sign: small whole numbers count things.
"""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[3]
# Pages and their appendices.
PAGES = {
    "README.md": ("docs/study-tables.md", "docs/strong-optimizers.md"),
    "docs/results.md": (),
    "docs/results-runs.md": (),
    "docs/study.md": ("docs/study-tables.md",),
    "docs/newcomers.md": ("docs/newcomers-tables.md",),
    "docs/dynamic.md": ("docs/dynamic-tables.md",),
    "docs/optimizers.md": ("docs/optimizers-tables.md",),
    "docs/planners.md": ("docs/planners-tables.md",),
    "docs/curves.md": ("docs/planners-tables.md",),
    "docs/planning-wishes.md": (),
    "docs/scores.md": ("docs/scores-tables.md",),
    "docs/terrain.md": ("docs/terrain-tables.md",),
    "docs/terrain-budgets.md": ("docs/terrain-budgets-tables.md", "docs/terrain.md"),
    "docs/terrain-scenarios.md": (),
    "docs/bbob.md": ("docs/bbob-tables.md",),
    "docs/known-optimum.md": ("docs/known-optimum-tables.md",),
    "docs/learners.md": ("docs/learners-tables.md",),
    "docs/strong-optimizers.md": ("docs/strong-optimizers-tables.md",),
}
# Numbers that are no results: seeds, steps of trainings and tunings, values of options; two that were
# measured on training seeds while a recipe was chosen; and the largest difference to a published cost.
EXCEPTIONS = {
    "docs/study.md": {"199,999", "30,000", "500,000", "4.14"},
    "docs/dynamic.md": {"56,000"},
    "docs/optimizers.md": {"8.1 %", "921,600", "460,800"},
    "docs/planners.md": {"8 %"},
    "docs/planning-wishes.md": {"0.1 %", "0.2 %", "0.4", "1,300", "1,680", "160,000", "5 %"},
    "docs/known-optimum.md": {"100,000", "0.001"},
    "docs/strong-optimizers.md": {"600,000", "190,000", "1,500"},
    "docs/terrain.md": {"2501.14503"},
    "docs/terrain-scenarios.md": {"1,000,000", "10,000", "100,000", "2,500", "2501.14503", "4.4", "6.5"},
    "docs/learners.md": {"199,999", "20,000", "0.025", "0.1", "0.5"},
}
NUMBER = re.compile(r"(?<![\w.,@:/+-])[+-]?(\d+(?:,\d{3})*(?:\.\d+)?(?: %)?)(?![\w,]*\d)")
BLOCK = re.compile(r"<!-- (\S+) -->\n.*?<!-- /\1 -->", re.DOTALL)
CODE = re.compile(r"```.*?```|`[^`]*`|\]\([^)]*\)", re.DOTALL)


def blocks_of(text):
    """Return what generated blocks of a page say."""
    return " ".join(found[0] for found in BLOCK.finditer(text))


def by_hand(text, blocks, exceptions=frozenset()):
    """Return the numbers of the prose that no block has."""
    prose = CODE.sub(" ", BLOCK.sub(" ", text))
    numbers = {number for number in NUMBER.findall(prose) if re.search(r"[.,%]", number)}
    missing = {
        number for number in numbers if not re.search(rf"(?<![\d.,]){re.escape(number)}(?!\d)", blocks)
    }
    return sorted(missing - set(exceptions))


@pytest.mark.parametrize("page", PAGES)
def test_numbers_in_prose_are_those_of_generated_blocks(page):
    text, *appendices = ((ROOT / name).read_text(encoding="utf-8") for name in (page, *PAGES[page]))
    blocks = blocks_of("\n".join([text, *appendices]))
    assert by_hand(text, blocks, EXCEPTIONS.get(page, ())) == []


@pytest.mark.parametrize("page", EXCEPTIONS)
def test_exceptions_are_still_needed(page):
    text, *appendices = ((ROOT / name).read_text(encoding="utf-8") for name in (page, *PAGES[page]))
    assert by_hand(text, blocks_of("\n".join([text, *appendices]))) == sorted(EXCEPTIONS[page])


def test_a_number_that_no_block_has_is_found():
    text = "A gap of 0.12 % at 13,636, not 0.13 %.\n<!-- a -->\n0.12 % at 13,636\n<!-- /a -->\n`0.7` [x](1.5)"
    assert by_hand(text, blocks_of(text)) == ["0.13 %"]

"""What the documents point to is there; in a fresh clone that means it is committed."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
PAGES = ["README.md", *(str(path.relative_to(ROOT)) for path in sorted(ROOT.glob("docs/**/*.md")))]


@pytest.mark.parametrize("page", PAGES)
def test_every_relative_link_leads_to_a_file(page):
    targets = re.findall(r"\]\(([^)#\s]+)\)", (ROOT / page).read_text(encoding="utf-8"))
    relative = [target for target in targets if "://" not in target]
    missing = [target for target in relative if not (ROOT / page).parent.joinpath(target).exists()]
    assert missing == []


def test_the_results_are_among_the_pages_and_show_figures():
    assert "docs/results/README.md" in PAGES
    assert (ROOT / "docs/results/README.md").read_text(encoding="utf-8").count(".svg)") == 14

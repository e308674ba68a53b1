"""Parts of the generator of the site: docstrings, links of documents, and checks of built pages."""

import pytest

from experiments.site.check_links import BrokenLinksError, check_links
from experiments.site.commands import help_of
from experiments.site.markdown import entries, first_sentence, linked, prose, table, topic
from experiments.site.markup import MISSING, accessible, legible, to_restructured_text
from experiments.site.pages import on_site
from experiments.site.reference import public_names
from swarm_gym import reward
from swarm_gym.env import SwarmEnv
from swarm_gym.settings import Settings


def test_inline_code_becomes_a_literal_and_a_full_name_a_reference():
    assert to_restructured_text(["Take `size` of `swarm_gym.env.SwarmEnv`."]) == [
        "Take ``size`` of :py:obj:`swarm_gym.env.SwarmEnv`.",
        "",
    ]


def test_a_table_becomes_a_directive():
    lines = to_restructured_text(["Before:", "", "| a | `b` |", "|---|---|", "| 1 | x |", "After."])
    assert lines == [
        "Before:", "", ".. list-table::", "   :header-rows: 1", "",
        "   * - a", "     - ``b``", "   * - 1", "     - x", "", "After.", "",
    ]  # fmt: skip


def test_an_example_becomes_a_code_block_but_sections_and_lists_stay():
    text = [
        "Do:",
        "",
        "    x = `1`",
        "",
        "* one",
        "",
        "    more",
        "",
        "Args:",
        "    x: a number `n`.",
        "",
        "    y: b.",
    ]
    lines = to_restructured_text(text)
    assert lines[2:5] == [".. code-block:: python", "", "    x = `1`"]
    assert "    more" in lines
    assert "    x: a number ``n``." in lines
    assert lines.count(".. code-block:: python") == 1


def test_parts_of_docstrings_are_found():
    assert first_sentence(reward.final).startswith("Return log(initial gap / final gap) at the end")
    assert prose(SwarmEnv).endswith("See docs/scenarios-functions.md.")
    assert (
        entries(Settings, "Attributes")["iterations"] == "g_max, number of steps of an episode, at least 1."
    )
    assert entries(Settings, "Attributes").keys() == Settings.__dataclass_fields__.keys()
    assert topic(SwarmEnv, "Info").startswith("| key | value |")
    with pytest.raises(ValueError, match=r"expected the title \*\*Nothing\*\*"):
        topic(SwarmEnv, "Nothing")


def test_a_bar_in_a_cell_is_escaped_and_a_document_is_linked():
    assert table(["a"], [["x | y\nz"]]).endswith("| x \\| y z |")
    assert linked("see docs/readings.md.") == "see [readings.md](../readings.md)."
    assert linked("[docs/readings.md](../readings.md)") == "[docs/readings.md](../readings.md)"


@pytest.mark.parametrize(
    ("document", "link", "expected"),
    [
        ("docs/guide.md", "[guide](../README.md)", "[guide](index.md)"),
        ("docs/architecture.md", "[c](../CONTRIBUTING.md#rules)", "[c](contributing.md#rules)"),
        ("docs/results/README.md", "[c](../../CHANGELOG.md)", "[c](../changelog.md)"),
        ("docs/guide.md", "[`env`](../swarm_gym/env.py)", "{py:mod}`env <swarm_gym.env>`"),
        ("docs/guide.md", "[m](../experiments/scaling/model.py)", "[m](../experiments/scaling/model.py)"),
        ("docs/scores.md", "[scores](../swarm_gym)", "scores"),
        ("docs/guide.md", "[x](study.md)", "[x](study.md)"),
        ("docs/guide.md", "[x](../LICENSE)", "[x](../LICENSE)"),
        ("CONTRIBUTING.md", "[x](docs/study.md#a)", "[x](study.md#a)"),
        ("CONTRIBUTING.md", "[x](LICENSE)", "[x](../LICENSE)"),
        ("docs/guide.md", "[x](https://example.org/a)", "[x](https://example.org/a)"),
        ("docs/guide.md", "[x](absent.md)", "[x](absent.md)"),
        ("docs/guide.md", "```\n[x](../README.md)\n```", "```\n[x](../README.md)\n```"),
    ],
)
def test_links_of_documents_lead_to_pages_of_the_site(document, link, expected, pytestconfig):
    once = on_site(link, document, pytestconfig.rootpath)
    assert once == expected


def test_public_names_are_those_that_a_module_defines():
    assert public_names(reward) == (
        "LARGEST_DETOUR", "LEAST_GAP", "Transition", "progress", "final", "optimality", "offline_error",
        "anytime", "anytime_and_end", "detour", "runtime", "final_gap", "offline_weight", "budget_shares",
        "REWARDS", "NEED_AN_OPTIMUM", "NEED_ROBOTS", "NEED_WEIGHTS", "COUNT_EVALUATIONS", "NEED_BITS",
        "NEED_A_BUDGET", "make_reward", "RewardCheck",
    )  # fmt: skip


def test_help_is_that_of_the_command_line():
    text = help_of("swarm_gym.plan")
    assert text.startswith("usage: python -m swarm_gym.plan [-h] --map MAP")
    assert "--robot-radius R" in text


def test_a_figure_is_as_wide_as_its_letters_need_and_scrolls(tmp_path):
    (tmp_path / "a b.svg").write_text(
        '<?xml version="1.0"?>\n<svg xmlns="x" width="576pt" height="9pt"></svg>'
    )
    (tmp_path / "pixels.svg").write_text('<svg width="576" height="9"></svg>')
    page = '<p><img alt="A" src="a%20b.svg" /></p>'
    wide = (
        '<p class="figure" tabindex="0" role="group" aria-label="Figure">'
        '<img alt="A" src="a%20b.svg" style="min-width: 576px" /></p>'
    )
    assert legible(page, tmp_path) == wide
    assert legible(wide, tmp_path) == wide
    for other in (
        '<p><img src="pixels.svg" /></p>',
        '<p><img src="absent.svg" /></p>',
        '<p><img src="a.png" /></p>',
    ):
        assert legible(other, tmp_path) == other


def write_site(folder, **pages):
    for name, body in pages.items():
        (folder / f"{name}.html").write_text(f"<html><body>{body}</body></html>")


def test_links_and_anchors_of_a_site_are_counted(tmp_path):
    write_site(
        tmp_path, a='<h1 id="x y">A</h1><a href="b.html#z">b</a><a href="#x%20y">x</a>', b='<p id="z">B</p>'
    )
    (tmp_path / "image.png").write_bytes(b"")
    write_site(
        tmp_path, c='<img src="image.png"><a href="https://example.org">out</a><a href="a.html?q=1">a</a>'
    )
    assert check_links(tmp_path) == 4


@pytest.mark.parametrize(
    ("body", "fault"),
    [
        ('<a href="absent.html">x</a>', "absent.html leads to no file"),
        ('<a href="#absent">x</a>', "#absent leads to no element of that page"),
        ('<img src="../image.png">', "../image.png leads out of the site"),
    ],
)
def test_a_broken_link_is_named(tmp_path, body, fault):
    write_site(tmp_path, page=f'<a href="page.html">ok</a>{body}')
    with pytest.raises(BrokenLinksError, match=r"1 of 2 internal links are broken:\npage\.html: ") as caught:
        check_links(tmp_path)
    assert str(caught.value).endswith(fault)


def test_a_folder_without_pages_is_no_site(tmp_path):
    with pytest.raises(BrokenLinksError, match="expected a built site"):
        check_links(tmp_path)


def test_tags_get_what_they_lack_once():
    page = "".join(f"{tag}>" for tag in MISSING)
    better = accessible(page)
    assert all(f"{tag} {attributes}>" in better for tag, attributes in MISSING.items())
    assert accessible(better) == better

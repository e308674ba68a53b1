"""The page of a report as its readers have it: in a browser, from disk, by mouse and by keyboard.

Needs Chromium (`make browser`); without one, or without Playwright, these tests are skipped. With
UPDATE_SCREENSHOTS=1 in the environment, the stored screenshots are replaced instead of compared.
"""

import base64
import dataclasses
import io
import json
import os
import re
import sqlite3
from pathlib import Path

import numpy as np
import pytest
from PIL import Image, ImageFilter

from experiments.catalogue import SUITES
from experiments.evaluate import EvaluateConfig, evaluate
from experiments.report.__main__ import ReportConfig, write_report
from experiments.report.recording import record
from experiments.runs.database import Results
from helpers.browsers import DESKTOP, PHONE, chromium, lightness, opener, wider_than
from helpers.reports import SUITE
from helpers.slow import slow_but
from helpers.stored_runs import make_database

axe = pytest.importorskip("axe_playwright_python.sync_playwright", reason="needs axe, of the group dev")

SCREENSHOTS = Path(__file__).parent / "screenshots"


@pytest.fixture(scope="module")
def browser():
    with chromium() as launched:
        yield launched


@pytest.fixture(scope="module")
def database(tmp_path_factory):
    return make_database(tmp_path_factory.mktemp("results") / "tiny.sqlite", SUITE)


@pytest.fixture(scope="module")
def report(database):
    with pytest.MonkeyPatch.context() as patch:
        patch.setitem(SUITES, "tiny", SUITE)
        return write_report(ReportConfig(database))


@pytest.fixture
def open_page(browser):
    """Opens a file; what the console says and what is asked of a network is kept on the page."""
    with opener(browser) as open_any:

        def opened(*asked, **options):
            page = open_any(*asked, **options)
            if page.locator(".player").count():
                page.wait_for_selector(".player[data-ready]")
            return page

        yield opened


@pytest.fixture
def page(report, open_page):
    return open_page(report)


def test_the_page_opens_from_disk_without_errors_or_requests(page, report):
    assert page.complaints == []
    assert [url for url in page.requests if not url.startswith("data:")] == [report.as_uri()]
    assert page.title() == "swarm_gym: suite tiny"


@pytest.mark.parametrize("which", slow_but(["TRUE"], ["TRUE", "seed = 2 AND controller = 'spsfa'"]))
def test_an_empty_or_partial_report_opens_without_errors(database, tmp_path, open_page, which, monkeypatch):
    monkeypatch.setitem(SUITES, "tiny", SUITE)
    copy = tmp_path / "tiny.sqlite"
    copy.write_bytes(database.read_bytes())
    with sqlite3.connect(copy) as connection:
        connection.execute(f"DELETE FROM runs WHERE {which}")
    connection.close()
    page = open_page(write_report(ReportConfig(copy, figures=False)))
    assert page.complaints == []
    assert page.locator(".notices li").count() >= 1


def column(page, table, number):
    cells = page.locator(f"table[data-name='{table}'] tbody tr > :nth-child({number})")
    return cells.all_text_contents()


def test_tables_sort_by_numbers_and_by_names_either_way(page):
    fitness = column(page, "summary", 2)
    heads = page.locator("table[data-name='summary'] thead th")
    button = heads.nth(1).get_by_role("button")
    for press, way in ((button.click, "ascending"), (lambda: button.press("Enter"), "descending")):
        press()
        assert heads.nth(1).get_attribute("aria-sort") == way
        assert sorted(column(page, "summary", 2)) == sorted(fitness)
        numbers = [float(re.match(r"[\d.]+", text)[0]) for text in column(page, "summary", 2)]
        assert numbers == sorted(numbers, reverse=way == "descending")
    heads.nth(0).get_by_role("button").click()
    assert heads.nth(1).get_attribute("aria-sort") is None
    names = column(page, "summary", 1)
    assert names == sorted(names, key=str.casefold)


@pytest.mark.slow
def test_what_is_missing_is_sorted_last_either_way(page):
    button = page.locator("table[data-name='optimal-solutions-random-fields:test:0'] thead th").nth(1)
    body = "table[data-name='optimal-solutions-random-fields:test:0'] tbody tr:first-child > :nth-child(2)"
    page.eval_on_selector(body, "cell => { cell.textContent = '–' }")
    for _ in range(2):
        button.get_by_role("button").click()
        assert column(page, "optimal-solutions-random-fields:test:0", 2)[-1] == "–"


def iteration(page):
    return int(page.locator(".player input[type=range]").input_value())


def drawn(page, side, kind):
    """Coordinates of the lines of a kind on one side, (lines, points, 2), in pixels of the picture."""
    d = page.locator(".pane").nth(side).locator(f".map > path.{kind}").get_attribute("d")
    return [np.array([point.split(",") for point in line.split("L")], float) for line in d.split("M")[1:]]


def test_the_player_steps_and_seeks_by_mouse_and_by_keyboard(page):
    assert iteration(page) == 0
    page.get_by_role("button", name="One iteration forward").click()
    page.get_by_role("button", name="One iteration forward").press("Space")
    assert iteration(page) == 2
    page.get_by_role("button", name="One iteration back").click()
    assert iteration(page) == 1
    slider = page.get_by_role("slider", name="Iteration")
    slider.press("ArrowRight")
    assert iteration(page) == 2
    slider.press("End")
    assert iteration(page) == 12
    page.get_by_role("button", name="One iteration forward").click()
    assert iteration(page) == 12
    slider.fill("7")
    assert slider.get_attribute("aria-valuetext") == "iteration 7 of 12"
    for state in page.locator(".state").all_text_contents():
        assert state.startswith("Iteration 7: ")
    assert "Iteration 7: " in page.locator(".player").get_by_role("status").text_content()
    assert page.complaints == []


@pytest.mark.slow
def test_the_player_plays_to_the_end_and_pauses(page):
    page.get_by_label("Per second").select_option("30")
    button = page.locator(".player .play")
    button.click()
    assert button.text_content() == "Pause"
    page.wait_for_function("document.querySelector('.player input[type=range]').value === '12'")
    page.wait_for_function("document.querySelector('.player .play').textContent === 'Play'")
    page.get_by_label("Per second").select_option("2")
    button.press("Enter")
    page.wait_for_function("document.querySelector('.player input[type=range]').value === '1'")
    button.click()
    paused = iteration(page)
    page.wait_for_timeout(700)
    assert iteration(page) == paused < 12


@pytest.mark.slow
def test_courses_have_a_line_where_the_map_changes(tmp_path, open_page, monkeypatch, page):
    assert page.locator(".courses .event").first.get_attribute("d") == ""
    changing = dataclasses.replace(SUITE, name="changing", scenarios=("dynamic:case1-gate@5",))
    monkeypatch.setitem(SUITES, "changing", changing)
    report = write_report(ReportConfig(make_database(tmp_path / "changing.sqlite", changing), figures=False))
    page = open_page(report)
    assert page.complaints == []
    assert page.locator(".playground").count() == 0  # its port has no maps that change
    lines = [line.get_attribute("d") for line in page.locator(".courses .event").all()]
    assert len(set(lines)) == 1
    # The gate follows the fifth of twelve iterations; charts are 200 wide with a margin of 6.
    [x] = re.findall(r"M([0-9.]+) 0V90", lines[0])
    assert float(x) == pytest.approx(194 * 5 / 12, abs=0.1)


def test_the_player_shows_the_populations_of_the_runs(page, database):
    results = Results.stored(database)
    for place, controller in enumerate(SUITE.replayed):
        [run] = results.runs(controller, "case1", 1)
        frames = record(run, SUITE).frames
        for at in (0, 1, 5, 12):
            page.get_by_role("slider", name="Iteration").fill(str(at))
            frame = frames[at]
            lines = {kind: drawn(page, place, kind) for kind in ("feasible", "colliding", "new", "removed")}
            assert len(lines["feasible"]) == frame.feasible.sum()
            assert len(lines["colliding"]) == (~frame.feasible).sum()
            assert len(lines["new"]) == frame.new.sum()
            assert len(lines["removed"]) == frame.removed.sum()
            for kind, of_kind in (("feasible", frame.feasible), ("colliding", ~frame.feasible)):
                expected = np.clip(frame.paths[of_kind], [0, 0], [1000, 600])
                for line, path in zip(lines[kind], expected, strict=True):
                    np.testing.assert_allclose(line, [0, 600] + path * [1, -1], atol=0.6)
            [best] = drawn(page, place, "best")
            np.testing.assert_allclose(best, [0, 600] + frame.best_path * [1, -1], atol=0.6)
            said = page.locator(".state").nth(place).text_content()
            feasible, colliding = frame.feasible.sum(), (~frame.feasible).sum()
            assert f"{len(frame.paths)} members, {feasible} feasible, {colliding} colliding" in said
            assert f"{frame.new.sum()} new, {frame.removed.sum()} removed" in said
            assert ("which collides" in said) == (not frame.best_feasible)
    results.close()


def test_two_controllers_and_other_scenarios_can_be_chosen(page):
    sides = [page.get_by_label(f"{side} controller") for side in ("Left", "Right")]
    assert [side.evaluate("s => s.selectedOptions[0].text") for side in sides] == ["SPSFA-TIP", "SPSFA"]
    sides[0].select_option("SPSFA")
    page.get_by_role("slider", name="Iteration").fill("12")
    before = drawn(page, 0, "best")
    for kind in ("feasible", "best"):
        left, right = drawn(page, 0, kind), drawn(page, 1, kind)
        np.testing.assert_array_equal(left, right)
    page.locator(".task").select_option("random-fields:test:0, seed 0")
    page.wait_for_function("document.querySelectorAll('.pane .map .obstacle').length > 0")
    assert page.locator(".task").input_value() == "1"
    now = drawn(page, 0, "best")
    assert all(not np.array_equal(now[0], line) for line in before)
    assert page.complaints == []


@pytest.mark.parametrize(
    ("viewport", "color_scheme"),
    slow_but(
        [(PHONE, "light")], [(size, colours) for size in (PHONE, DESKTOP) for colours in ("light", "dark")]
    ),
)
def test_nothing_is_wider_than_the_screen(report, open_page, viewport, color_scheme):
    page = open_page(report, viewport, color_scheme)
    assert page.evaluate("document.documentElement.scrollWidth") == viewport["width"]
    assert wider_than(page, viewport["width"]) == []


@pytest.mark.slow
def test_colours_are_the_systems_until_others_are_chosen(report, open_page):
    light, dark = (open_page(report, color_scheme=scheme) for scheme in ("light", "dark"))
    assert lightness(light) > 200
    assert lightness(dark) < 60
    button = dark.get_by_role("button", name="Colours")
    seen = []
    for _ in range(3):
        button.click()
        seen.append((button.text_content(), lightness(dark) > 128))
    assert seen == [("Colours: light", True), ("Colours: dark", False), ("Colours: system", False)]


@pytest.mark.parametrize(
    ("viewport", "color_scheme"),
    [
        (PHONE, "light"),
        pytest.param(DESKTOP, "light", marks=pytest.mark.slow),
        pytest.param(DESKTOP, "dark", marks=pytest.mark.slow),
    ],
)
def test_axe_finds_nothing_serious(report, open_page, viewport, color_scheme):
    page = open_page(report, viewport, color_scheme)
    found = axe.Axe().run(page).response["violations"]
    assert [(v["id"], v["impact"]) for v in found if v["impact"] in ("serious", "critical")] == []


@pytest.mark.slow
def test_everything_can_be_reached_with_the_tabulator(page):
    reached = set()
    for _ in range(200):
        page.keyboard.press("Tab")
        reached.add(page.evaluate("document.activeElement.textContent.trim().slice(0, 24)"))
        if page.evaluate("document.activeElement.closest('details') !== null"):
            break
    for what in ("Skip to the results", "Colours: system", "Results", "Play", "◀", "controller"):
        assert what in reached


@pytest.mark.slow
def test_a_printed_page_has_its_tables_and_none_of_its_buttons(report, open_page):
    page = open_page(report, color_scheme="dark")
    page.emulate_media(media="print")
    assert lightness(page) > 200
    assert not page.locator(".player .controls").is_visible()
    assert not page.locator("nav").is_visible()
    assert page.locator("table[data-name='summary']").is_visible()
    assert len(page.pdf()) > 50_000


PICTURES = [
    ("map-light", ".pane .map", DESKTOP, "light", 1.5),
    ("map-dark", ".pane .map", DESKTOP, "dark", 1.5),
    ("player-phone", ".player", PHONE, "light", 4.0),
    ("player-desktop", ".player", DESKTOP, "light", 4.0),
]


def assert_looks_like(picture, name, tolerance):
    """Blurred, so that fonts and smoothing may differ a little; where they do not, it is about 0."""
    path = SCREENSHOTS / f"{name}.png"
    now = Image.open(io.BytesIO(picture)).convert("RGB")
    if os.environ.get("UPDATE_SCREENSHOTS"):
        path.parent.mkdir(exist_ok=True)
        now.quantize(64).save(path, optimize=True)
        return
    then = Image.open(path).convert("RGB")
    assert abs(now.height - then.height) <= 0.1 * then.height
    assert now.width == then.width
    both = [image.resize(then.size).filter(ImageFilter.GaussianBlur(3)) for image in (now, then)]
    one, other = (np.asarray(image, dtype=float) for image in both)
    difference = np.abs(one - other).mean()
    assert difference <= tolerance, f"{name} differs by {difference:.2f} of 255 on average"


@pytest.mark.parametrize(
    ("name", "part", "viewport", "color_scheme", "tolerance"),
    slow_but(
        [PICTURES[1], PICTURES[2]],
        PICTURES,
    ),
)
def test_the_player_looks_as_it_did(report, open_page, name, part, viewport, color_scheme, tolerance):
    page = open_page(report, viewport, color_scheme)
    page.get_by_role("slider", name="Iteration").fill("3")
    # A busy machine draws later: two frames follow what the slider asked for.
    page.evaluate("new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))")
    assert_looks_like(page.locator(part).first.screenshot(), name, tolerance)


@pytest.mark.slow
def test_the_top_of_the_page_looks_as_it_did(page):
    assert_looks_like(page.screenshot(), "top", tolerance=5.0)


@pytest.mark.slow
def test_the_report_of_the_papers_suite_is_small_and_opens_at_once(tmp_path, open_page):
    evaluate(EvaluateConfig(output=tmp_path, figures=False))
    report = write_report(ReportConfig(tmp_path / "paper.sqlite"))
    assert report.stat().st_size < 5_000_000
    groups = json.loads(re.search(r'id="replay-data">(.*?)</script>', report.read_text())[1])
    for group in groups:
        for replay in group["replays"]:
            assert len(json.dumps(replay)) <= 300_000
            assert base64.b64decode(replay["data"])
    taken = []
    for _ in range(3):  # the least of three, since other tests run beside this one
        page = open_page(report)
        taken.append(page.evaluate("performance.now()"))
    assert min(taken) < 2000.0, f"the page took {min(taken):.0f} ms to open"


def test_a_reader_can_steer_a_swarm_on_the_suites_maps(page):
    playground = page.locator(".playground")
    maps = playground.get_by_label("Map").locator("option").all_text_contents()
    assert maps == list(SUITE.scenarios)
    playground.get_by_role("button", name="Step").click()
    page.wait_for_function("document.querySelector('.playground').dataset.iteration === '1'")
    assert playground.get_by_role("status").text_content().startswith("Iteration 1 of 12. ")
    page.get_by_role("link", name="Playground").click()
    assert page.get_by_role("heading", name="Steer a swarm by hand").is_visible()
    assert page.complaints == []


def test_a_replay_without_a_rival_has_one_side(database, tmp_path, open_page, monkeypatch):
    monkeypatch.setitem(SUITES, "tiny", dataclasses.replace(SUITE))
    asked = ReportConfig(database, output=tmp_path / "page.html", replays=("fixed:8,case1,1",), figures=False)
    page = open_page(write_report(asked))
    assert [pane.is_visible() for pane in page.locator(".pane").all()] == [True, False]
    assert page.complaints == []

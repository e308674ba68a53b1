"""The site as its readers have it: built once, all links checked, looked at in a browser.

Needs the dependency group `docs`, and Chromium (`make browser`) for the pages in a browser. Notebooks are
not run here; `make docs` runs them.
"""

import re
import subprocess
import sys
from itertools import product
from pathlib import Path
from urllib.parse import unquote

import pytest
from filelock import FileLock

from experiments.site.check_links import check_links
from experiments.site.pages import generated_pages
from swarm_gym.optimizers import OPTIMIZERS

for library in ("sphinx", "furo", "myst_nb", "sphinx_design", "sphinx_copybutton", "ipykernel"):
    pytest.importorskip(library, reason="needs the dependency group `docs`")

pytestmark = pytest.mark.slow

ROOT = Path(__file__).parents[3]
WIDTHS, SCHEMES = (1400, 390), ("light", "dark")
TUTORIALS = sorted(path.stem for path in ROOT.glob("docs/tutorials/*.md") if path.stem != "index")
LOOKED_AT = (
    "index", "environments/firefly", "environments/ant-colony", "study", "reference/index",
    "learners", "terrain", "curves", "layouts", "planning", "flights",
    "reference/layouts", "reference/all-controllers", "reference/commands",
    *(f"tutorials/{name}" for name in TUTORIALS[:1]),
)  # fmt: skip
# All pages that are written by hand; those of `LOOKED_AT` in every window, and the others on a phone.
WRITTEN = sorted(path.stem for path in ROOT.glob("docs/*.md"))
LARGEST_ANIMATION = 500_000  # bytes


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    """The built site; all processes of a test run share one, since it takes minutes."""
    folder = tmp_path_factory.getbasetemp().parent / "built-site"
    with FileLock(folder.with_suffix(".lock")):
        if not (folder / "done").exists():
            # Without a kernel, Sphinx takes shell commands in notebooks for Python.
            unlike = ("nb_execution_mode=off", "suppress_warnings=misc.highlighting_failure")
            options = [word for setting in unlike for word in ("-D", setting)]
            places = ["-d", folder.with_suffix(".doctrees"), "docs", folder]
            built = subprocess.run(
                [sys.executable, "-m", "sphinx", "-W", "--keep-going", "-q", "-b", "html", *options, *places],
                cwd=ROOT, capture_output=True, text=True, check=False,
            )  # fmt: skip
            assert built.returncode == 0, built.stderr[-4000:]
            assert built.stderr == "", "the build warns"
            (folder / "done").touch()
    return folder


@pytest.fixture(scope="module")
def browser():
    from helpers.browsers import chromium  # skips the test without Playwright

    with chromium() as launched:
        yield launched


@pytest.fixture
def open_page(browser, site):
    """Opens a page of the site from disk; its errors and requests are kept on it."""
    contexts = []

    def opened(name, width, scheme):
        context = browser.new_context(
            viewport={"width": width, "height": 900}, color_scheme=scheme, reduced_motion="reduce"
        )
        contexts.append(context)
        page = context.new_page()
        page.complaints, page.requests = [], []
        page.on("pageerror", lambda error: page.complaints.append(str(error)))
        page.on("request", lambda request: page.requests.append(request.url))
        page.goto((site / f"{name}.html").as_uri())
        return page

    yield opened
    for context in contexts:
        context.close()


def test_every_link_and_anchor_leads_somewhere(site):
    assert check_links(site) > 10_000


def test_every_generated_page_is_on_the_site(site):
    names = [Path(name).with_suffix(".html") for name in generated_pages(ROOT)]
    assert [str(name) for name in names if not (site / name).is_file()] == []


def test_animations_are_there_and_small(site):
    sizes = {path.stem: path.stat().st_size for path in (site / "_images").glob("*.gif")}
    assert {name: sizes.get(name, 0) > 0 for name in OPTIMIZERS} == dict.fromkeys(OPTIMIZERS, True)
    assert max(sizes[name] for name in OPTIMIZERS) < LARGEST_ANIMATION


@pytest.mark.parametrize(
    ("name", "width", "scheme"),
    [
        *product(LOOKED_AT, WIDTHS, SCHEMES),
        *((name, min(WIDTHS), "dark") for name in WRITTEN if name not in LOOKED_AT),
    ],
)
def test_a_page_fits_its_window_and_axe_finds_nothing(open_page, name, width, scheme):
    axe = pytest.importorskip("axe_playwright_python.sync_playwright", reason="needs axe, of the group dev")
    page = open_page(name, width, scheme)
    element = "document.documentElement"
    assert page.evaluate(f"{element}.scrollWidth - {element}.clientWidth") == 0
    assert page.complaints == []
    assert [url for url in page.requests if not url.startswith(("file:", "data:"))] == []
    findings = axe.Axe().run(page).response["violations"]
    assert [(each["id"], [node["target"] for node in each["nodes"]][:3]) for each in findings] == []


def test_a_wide_table_scrolls_in_its_own_box(open_page):
    page = open_page("environments/firefly", 390, "light")
    boxes = page.locator(".table-wrapper")
    scroll = [
        boxes.nth(number).evaluate("box => box.scrollWidth - box.clientWidth")
        for number in range(boxes.count())
    ]
    assert max(scroll) > 0
    boxes.nth(scroll.index(max(scroll))).evaluate("box => { box.scrollLeft = 50 }")
    assert boxes.nth(scroll.index(max(scroll))).evaluate("box => box.scrollLeft") == 50


@pytest.mark.parametrize("name", ["study", "learners", "curves"])
def test_letters_of_figures_are_legible_on_a_phone(open_page, site, name):
    """Figures have letters of nine points; on a phone they are at least nine pixels high."""
    page = open_page(name, 390, "light")
    figures = page.locator("article p.figure img")
    assert figures.count() == page.locator("article img[src$='.svg']").count() > 0
    for number in range(figures.count()):
        figure = figures.nth(number)
        file = site / unquote(figure.get_attribute("src"))
        points = float(re.search(r'width="([\d.]+)pt"', file.read_text(encoding="utf-8"))[1])
        assert figure.bounding_box()["width"] >= points - 1
        assert figure.evaluate("image => getComputedStyle(image.parentElement).overflowX") == "auto"


def test_the_search_finds_a_page(open_page):
    page = open_page("search", 1400, "light")
    page.goto(page.url + "?q=glowworm")
    page.wait_for_selector("ul.search li a", timeout=20_000)
    assert page.locator("ul.search li a").count() >= 1

"""Chromium for tests of pages: without it, or without Playwright, tests are skipped with a reason.

`make browser` installs Chromium.
"""

import shutil
from contextlib import contextmanager
from pathlib import Path

import pytest

sync_api = pytest.importorskip("playwright.sync_api", reason="needs Playwright, of the group dev")

NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome")
ARGUMENTS = (
    "--no-sandbox", "--disable-gpu", "--disable-background-networking", "--disable-component-update",
    "--disable-sync", "--no-first-run", "--force-color-profile=srgb", "--hide-scrollbars",
)  # fmt: skip
PHONE, DESKTOP = {"width": 390, "height": 844}, {"width": 1280, "height": 900}


@contextmanager
def chromium():
    """Launch Chromium, or skip the test."""
    with sync_api.sync_playwright() as playwright:
        own = playwright.chromium.executable_path
        found = next(filter(None, map(shutil.which, NAMES)), own if Path(own).exists() else None)
        if found is None:
            pytest.skip("no Chromium is installed; see `make browser`")
        launched = playwright.chromium.launch(executable_path=found, args=list(ARGUMENTS))
        yield launched
        launched.close()


@contextmanager
def opener(browser):
    """Give a function that opens a file and keeps what the console says and what is asked of a network."""
    contexts = []

    def opened(path, viewport=DESKTOP, color_scheme="light", reduced_motion="reduce"):
        context = browser.new_context(
            viewport=viewport, color_scheme=color_scheme, reduced_motion=reduced_motion
        )
        contexts.append(context)
        page = context.new_page()
        page.set_default_timeout(10_000)
        page.complaints, page.requests = [], []
        page.on("console", lambda message: page.complaints.append(message.text))
        page.on("pageerror", lambda error: page.complaints.append(str(error)))
        page.on("request", lambda request: page.requests.append(request.url))
        page.goto(path.as_uri())
        return page

    yield opened
    for context in contexts:
        context.close()


def wider_than(page, width):
    """Return the beginnings of elements that reach beyond the width of the screen, in pixels."""
    outside = """width => [...document.querySelectorAll("body *")].filter((e) =>
        !e.closest(".scroll, pre, svg, .news, .skip") && e.getBoundingClientRect().right > width + 0.5
    ).map((e) => e.outerHTML.slice(0, 80))"""
    return page.evaluate(outside, width)


def lightness(page):
    """Return the lightness of the page's background, from 0 to 255."""
    red, green, blue = page.evaluate(
        "getComputedStyle(document.body).backgroundColor.match(/[0-9.]+/g).slice(0, 3).map(Number)"
    )
    return (red + green + blue) / 3

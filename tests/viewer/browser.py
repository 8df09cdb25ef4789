"""A browser for the tests of the page: Debian's Chromium, driven by Playwright."""

from __future__ import annotations

import os
import re
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from playwright.sync_api import Browser, BrowserContext, Page, expect, sync_playwright

FLAGS = [
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
]

WAIT_MS = 30_000  # for what must come; machines may be busy

PICTURES = Path(__file__).parents[2] / "build" / "page"
"""Where pictures of the page are left to be looked at; git does not know the folder."""


def need_browser() -> str:
    """Return where Chromium is; skip where there is none, but fail in CI."""
    found = shutil.which("chromium") or shutil.which("chromium-browser")
    if found is None:
        if os.environ.get("CI"):
            pytest.fail("chromium is not installed: the page was not tested")
        pytest.skip("chromium is not installed: the page was NOT tested (apt-get install chromium)")
    return found


@contextmanager
def running_browser() -> Iterator[Browser]:
    """Give a browser that runs as long as it is needed."""
    path = need_browser()
    expect.set_options(timeout=WAIT_MS)
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=path, args=FLAGS)
        yield browser
        browser.close()


@contextmanager
def opened_page(
    browser: Browser,
    address: str,
    *,
    width: int = 1280,
    height: int = 800,
    dark: bool = False,
    tolerate: str = "(?!)",
) -> Iterator[Page]:
    """Give a page at an address; no error may be written to its console.

    What the browser says of requests that are to be refused may be tolerated, by a pattern.
    """
    context: BrowserContext = browser.new_context(
        viewport={"width": width, "height": height},
        color_scheme="dark" if dark else "light",
        reduced_motion="reduce",
    )
    context.set_default_timeout(WAIT_MS)
    page = context.new_page()
    errors: list[str] = []
    page.on("console", lambda told: errors.append(told.text) if told.type == "error" else None)
    page.on("pageerror", lambda error: errors.append(str(error)))
    page.goto(address)
    yield page
    context.close()
    assert [error for error in errors if not re.search(tolerate, error)] == []


def picture(page: Page, name: str) -> None:
    """Leave a picture of the page to be looked at."""
    PICTURES.mkdir(parents=True, exist_ok=True)
    page.screenshot(path=PICTURES / f"{name}.png")

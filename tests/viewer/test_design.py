"""How the page is made: legible, reachable by keys, on all screens, and from here alone."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page, expect

from tests.servers import Server
from tests.service.twin import paper_session
from tests.viewer.browser import opened_page, picture
from tests.viewer.test_page import MAP, address, home, shows_step

VIEWER = Path(__file__).parents[2] / "service" / "viewer"
MODULES = sorted(VIEWER.glob("*.js"))
LINES_MAX = 250
CONTRAST_MIN = 4.5  # WCAG AA

TEXTS = [
    ("ink", "panel"), ("ink", "ground"), ("ink", "raised"), ("muted", "panel"), ("muted", "ground"),
    ("muted", "raised"), ("accent", "panel"), ("accent", "accent-soft"), ("accent-ink", "accent"),
    ("bad", "panel"), ("bad", "bad-soft"), ("good", "raised"), ("muted", "dim"),
]  # fmt: skip
"""Colours of letters, and what they stand on."""

LINES = [("wall", "dim"), ("frontier", "dim"), ("route", "panel"), ("trail", "dim")]
"""What is no letter needs a contrast of 3."""


def contrast(page: Page, one: str, other: str) -> float:
    """Return the contrast of two colours of the theme (WCAG 2, 1.4.3)."""
    value: float = page.evaluate(
        """([one, other]) => {
            const style = getComputedStyle(document.documentElement);
            const light = (name) => {
                const hex = style.getPropertyValue(`--${name}`).trim().slice(1);
                const parts = [0, 2, 4].map((n) => parseInt(hex.slice(n, n + 2), 16) / 255);
                const [r, g, b] = parts.map(
                    (c) => c <= .04045 ? c / 12.92 : ((c + .055) / 1.055) ** 2.4);
                return .2126 * r + .7152 * g + .0722 * b;
            };
            const [low, high] = [light(one), light(other)].sort((a, b) => a - b);
            return (high + .05) / (low + .05);
        }""",
        [one, other],
    )
    return value


@pytest.mark.parametrize("dark", [False, True], ids=["light", "dark"])
def test_colours_have_contrast(browser: Browser, server: Server, *, dark: bool) -> None:
    with opened_page(browser, home(server), dark=dark) as page:
        expect(page.locator("html")).to_have_attribute("data-theme", "dark" if dark else "light")
        poor = {pair: contrast(page, *pair) for pair in TEXTS}
        assert {pair: it for pair, it in poor.items() if it < CONTRAST_MIN} == {}
        poor = {pair: contrast(page, *pair) for pair in LINES}
        assert {pair: it for pair, it in poor.items() if it < 3} == {}


def test_colours_can_be_chosen(browser: Browser, server: Server) -> None:
    with opened_page(browser, home(server)) as page:
        page.locator("#theme").click()
        expect(page.locator("#theme")).to_have_accessible_name("Colours: light")
        page.locator("#theme").click()
        expect(page.locator("html")).to_have_attribute("data-theme", "dark")
        page.reload()
        expect(page.locator("html")).to_have_attribute("data-theme", "dark")


@pytest.mark.parametrize("dark", [False, True], ids=["light", "dark"])
@pytest.mark.parametrize(("width", "height"), [(390, 844), (1280, 800), (2560, 1440)])
def test_it_fits_the_screen(
    browser: Browser, server: Server, width: int, height: int, *, dark: bool
) -> None:
    path = paper_session(server, 81)
    with opened_page(browser, address(server, path), width=width, height=height, dark=dark) as page:
        shows_step(page, 81, 81)
        page.wait_for_timeout(300)
        assert page.evaluate("document.documentElement.scrollWidth") == width
        for name in (MAP, "canvas#graph", "#ask-form", "#time"):
            box = page.locator(name).bounding_box()
            assert box is not None
            assert box["x"] >= 0
            assert box["x"] + box["width"] <= width
        canvas = page.locator(MAP).bounding_box()
        assert canvas is not None
        assert canvas["height"] >= 280
        picture(page, f"paper-{width}-{'dark' if dark else 'light'}")


def test_on_a_phone_a_finger_hits_every_control(browser: Browser, server: Server) -> None:
    path = paper_session(server, 81)
    with opened_page(browser, address(server, path), width=390, height=844) as page:
        shows_step(page, 81, 81)
        page.fill("#question", "path from corridor to C")
        page.keyboard.press("Enter")
        expect(page.locator("#answer")).to_contain_text("Leave corridor")
        page.locator("#tables summary").click()
        expect(page.locator("#tables table")).to_have_count(2)
        controls = page.locator("button:visible, .quiet:visible, input:visible").all()
        assert len(controls) > 25
        for control in controls:
            box = control.bounding_box()
            assert box is not None
            assert box["height"] >= 44, control.evaluate("it => it.outerHTML")


def test_everything_has_a_name_and_is_reached_by_keys(browser: Browser, server: Server) -> None:
    path = paper_session(server, 81)
    with opened_page(browser, address(server, path)) as page:
        shows_step(page, 81, 81)
        controls = page.locator(
            "button:visible, input:visible, a:visible, canvas[tabindex]:visible"
        )
        for control in controls.all():
            expect(control).to_have_accessible_name(re.compile(r"\w"))
        for role in ("banner", "main", "navigation"):
            assert page.get_by_role(role).count() == 1
        reached = set()
        for _ in range(60):
            page.keyboard.press("Tab")
            reached.add(page.evaluate("document.activeElement.id"))
        assert reached >= {"map", "graph", "question", "time", "play", "live", "drive", "theme"}


def test_map_moves_by_keys(browser: Browser, server: Server) -> None:
    path = paper_session(server, 81)
    with opened_page(browser, address(server, path)) as page:
        shows_step(page, 81, 81)
        page.wait_for_timeout(300)
        page.locator(MAP).focus()
        seen = [page.locator(MAP).screenshot()]
        for key in ("ArrowLeft", "+", "0"):
            page.keyboard.press(key)
            page.wait_for_timeout(150)
            seen.append(page.locator(MAP).screenshot())
        assert len(set(seen[:3])) == 3
        assert seen[3] == seen[0]


def test_answers_are_spoken(browser: Browser, server: Server) -> None:
    with opened_page(browser, home(server)) as page:
        assert page.locator("#answer").get_attribute("aria-live") == "polite"
        assert page.locator("#notices").get_attribute("aria-live") == "assertive"


def test_nothing_comes_from_elsewhere(browser: Browser, server: Server) -> None:
    path = paper_session(server, 5)
    with opened_page(browser, "about:blank") as page:
        asked: list[str] = []
        page.on("request", lambda request: asked.append(request.url))
        page.goto(address(server, path))
        shows_step(page, 5, 5)
        assert len(asked) > len(MODULES)
        assert [url for url in asked if not url.startswith(str(server.client.base_url))] == []


def test_only_files_of_the_page_may_run(server: Server) -> None:
    for path in ("/", "/viewer/main.js", "/viewer/example/world.json"):
        policy = server.client.get(path).headers["Content-Security-Policy"]
        assert "default-src 'none'" in policy
        assert "script-src 'self'" in policy
        assert "unsafe" not in policy
    text = (VIEWER / "index.html").read_text(encoding="utf-8")
    assert not re.search(r"<script>|<style|\son\w+=|style=", text)
    loaded = set(re.findall(r'(?:href|src)="viewer/(\w+\.js)"', text))
    assert loaded == {module.name for module in MODULES}


def test_the_example_is_that_of_the_readme(server: Server) -> None:
    folder = VIEWER.parents[1] / "examples" / "paper"
    for name in ("world.json", "path.csv"):
        assert server.get(f"/viewer/example/{name}") == (folder / name).read_bytes()


@pytest.mark.parametrize("module", MODULES, ids=lambda path: path.name)
def test_modules_are_small_and_careful(module: Path) -> None:
    text = module.read_text(encoding="utf-8")
    lines = [line for line in text.splitlines() if line.strip()]
    assert len(lines) <= LINES_MAX
    assert text.startswith("/**")
    for risky in (
        "innerHTML",
        "outerHTML",
        "insertAdjacentHTML",
        "document.write",
        "eval(",
        "http://",
    ):
        assert risky not in text


def test_events_are_understood_however_they_are_cut(browser: Browser, server: Server) -> None:
    text = ': hello\r\nid: 4\n\nevent: step\r\ndata: {"a":\ndata: 1}\nid: 5\n\ndata:x\r\n\r\n'
    with opened_page(browser, home(server)) as page:
        told = page.evaluate(
            """async (text) => {
                const { eventParser } = await import("/viewer/stream.js");
                const all = [];
                for (let cut = 0; cut < text.length; cut += 1) {
                    for (const more of [1, 7, text.length]) {
                        const told = [];
                        const parser = eventParser((...event) => told.push(event), "3");
                        parser.feed(text.slice(0, cut));
                        parser.feed(text.slice(cut, cut + more));
                        told.push(parser.feed(text.slice(cut + more)));
                        all.push(told);
                    }
                }
                return all;
            }""",
            text,
        )
    expected = [["step", '{"a":\n1}', "5"], ["message", "x", "5"], "5"]
    assert all(one == expected for one in told)
    assert len(told) > 100

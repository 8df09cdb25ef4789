"""The page as those see it who see little, or use no mouse: names, headings, contrast, focus."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from itertools import pairwise
from typing import Literal

import pytest
from playwright.sync_api import Browser, FloatRect, Page, expect

from tests.servers import Server
from tests.service.twin import paper_session
from tests.viewer.browser import opened_page, picture
from tests.viewer.test_page import address, ask, home, shows_step

CONTROLS = ", ".join(
    f"{it}:visible"
    for it in ("a[href]", "button", "input", "select", "summary", "[tabindex='0']", "textarea")
)

TEXT_MIN, LARGE_MIN, MARK_MIN = 4.5, 3.0, 3.0
"""Contrasts of letters, of large letters, and of what is no letter (WCAG 2.2, 1.4.3 and 1.4.11)."""

COLOURS = """
const ink = document.createElement("canvas").getContext("2d", { willReadFrequently: true });
const rgba = (colour) => {
    ink.clearRect(0, 0, 1, 1);
    ink.fillStyle = colour;
    ink.fillRect(0, 0, 1, 1);
    const [r, g, b, a] = ink.getImageData(0, 0, 1, 1).data;
    return [r, g, b, a / 255];
};
const over = ([r, g, b, a], below) => [r, g, b].map((c, n) => c * a + below[n] * (1 - a));
const ground = (element) => {
    const layers = [];
    for (let one = element; one; one = one.parentElement) {
        layers.push(rgba(getComputedStyle(one).backgroundColor));
        if (layers[layers.length - 1][3] === 1) break;
    }
    return layers.reverse().reduce((below, layer) => over(layer, below), [255, 255, 255]);
};
const light = (colour) => {
    const [r, g, b] = colour.map((c) => c / 255).map(
        (c) => c <= .04045 ? c / 12.92 : ((c + .055) / 1.055) ** 2.4);
    return .2126 * r + .7152 * g + .0722 * b;
};
const contrast = (one, other) => {
    const [low, high] = [light(one), light(other)].sort((a, b) => a - b);
    return (high + .05) / (low + .05);
};
"""

TEXTS = f"""() => {{ {COLOURS}
    const isShown = (one) => one.checkVisibility({{ visibilityProperty: true }});
    const own = (one) => [...one.childNodes].some((it) => it.nodeType === 3 && it.data.trim());
    const found = [];
    for (const one of document.querySelectorAll("body *")) {{
        if (!isShown(one) || one.matches(":disabled, script, noscript *, .unseen, .skip")) continue;
        const isField = one.matches("input:not([type=checkbox], [type=radio], [type=range])");
        if (!own(one) && !isField) continue;
        const style = getComputedStyle(one, isField && !one.value ? "::placeholder" : null);
        const behind = ground(one);
        const size = parseFloat(style.fontSize);
        const isLarge = size >= 24 || (size >= 18.66 && Number(style.fontWeight) >= 700);
        found.push([(one.textContent || one.placeholder || one.value).trim().slice(0, 40),
                    contrast(over(rgba(style.color), behind), behind), isLarge]);
    }}
    return found;
}}"""

HEADINGS = """() => [...document.querySelectorAll("h1, h2, h3, h4, h5, h6")]
    .filter((one) => one.checkVisibility({ visibilityProperty: true }))
    .map((one) => [Number(one.tagName[1]), one.textContent.trim()])"""

FOCUS = f"""() => {{ {COLOURS}
    const one = document.activeElement;
    const style = getComputedStyle(one);
    const behind = ground(one.parentElement);
    return {{
        tag: one.tagName, name: one.id || one.getAttribute("aria-label") || one.textContent.trim(),
        isRing: style.outlineStyle !== "none" && parseFloat(style.outlineWidth) >= 2,
        contrast: contrast(over(rgba(style.outlineColor), behind), behind),
    }};
}}"""


def empty_list(page: Page, server: Server) -> None:
    page.route("**/sessions?*", lambda it: it.fulfill(json={"sessions": [], "next": None}))
    page.goto(home(server))
    expect(page.get_by_role("heading", name="No map yet")).to_be_visible()


def full_list(page: Page, server: Server) -> None:
    server.create(name="one")
    page.goto(home(server))
    expect(page.locator(".card").first).to_be_visible()


def dialog(page: Page, server: Server) -> None:
    page.goto(home(server))
    page.get_by_role("button", name="New session").click()
    page.get_by_label("In a world of mine").check()
    page.locator("#sensor-field summary").click()
    expect(page.locator("#beams")).to_be_visible()


def nothing_explored(page: Page, server: Server) -> None:
    page.goto(address(server, server.create(name="a robot")))
    expect(page.locator("#map-hint")).to_be_visible()
    expect(page.locator("#details pre")).to_be_visible()


def explored(page: Page, server: Server) -> None:
    """Everything at once: a refusal, a selected zone that is closed, tables, layers, a notice."""
    path = paper_session(server, 29)
    page.goto(address(server, path))
    shows_step(page, 29, 29)
    ask(page, "path from corridor to C")
    expect(page.locator("#answer")).to_have_class(re.compile("refused"))
    page.locator("#tables summary").click()
    page.locator("#tables table").first.get_by_role("button", name="A", exact=True).click()
    page.get_by_role("button", name="Close A").first.click()
    expect(page.locator("#details .shut").first).to_be_visible()
    page.evaluate("import('/viewer/dom.js').then((it) => it.complain(new Error('It is so.')))")
    expect(page.locator(".notice")).to_be_visible()
    page.get_by_role("button", name="Layers").click()
    expect(page.locator("#layer-menu")).to_be_visible()


def answered(page: Page, server: Server) -> None:
    page.goto(address(server, paper_session(server, 81)))
    shows_step(page, 81, 81)
    ask(page, "path from A to C")
    expect(page.locator("#answer")).to_contain_text("The path keeps")
    page.locator("#time").fill("60")
    shows_step(page, 60, 81)


STATES: Mapping[str, Callable[[Page, Server], None]] = {
    it.__name__: it for it in (empty_list, full_list, dialog, nothing_explored, explored, answered)
}

THEMES: tuple[Literal["light", "dark"], ...] = ("light", "dark")
TOLERATED = "409"  # the question that is refused


def turn(page: Page, theme: Literal["light", "dark"]) -> None:
    """Let the system be light or dark, and wait until the page is."""
    page.emulate_media(color_scheme=theme)
    expect(page.locator("html")).to_have_attribute("data-theme", theme)


@pytest.mark.parametrize("state", STATES)
def test_it_can_be_read_and_named(browser: Browser, server: Server, state: str) -> None:
    with opened_page(browser, "about:blank", tolerate=TOLERATED) as page:
        STATES[state](page, server)
        check_headings(page)
        check_names(page)
        for theme in THEMES:
            turn(page, theme)
            picture(page, f"state-{state}-{theme}")
            check_texts(page)


def check_headings(page: Page) -> None:
    """One of the first level, and below it none that leaves a level out, or says nothing."""
    headings = page.evaluate(HEADINGS)
    levels = [level for level, _ in headings]
    assert levels[0] == 1
    assert levels.count(1) == 1
    assert all(below - above <= 1 for above, below in pairwise(levels))
    assert all(words for _, words in headings)


def check_names(page: Page) -> None:
    """Every control has a name, every table a caption and heads."""
    controls = page.locator(CONTROLS).all()
    assert len(controls) >= 4
    for control in controls:
        expect(control).to_have_accessible_name(re.compile(r"\w"))
    for table in page.locator("table:visible").all():
        assert table.locator("caption").inner_text()
        assert table.locator("th[scope=col]").count() > 1


def check_texts(page: Page) -> None:
    """All letters have a contrast to what they stand on."""
    texts = page.evaluate(TEXTS)
    assert len(texts) >= 5
    poor = [it for it in texts if it[1] < (LARGE_MIN if it[2] else TEXT_MIN)]
    assert poor == []


def test_what_cannot_be_read_is_found(browser: Browser, server: Server) -> None:
    """The checks are no better than what they find."""
    with opened_page(browser, "about:blank", tolerate=TOLERATED) as page:
        explored(page, server)
        before = len(page.evaluate(TEXTS))
        page.evaluate("document.documentElement.style.setProperty('--muted', '#8a93a3')")
        texts = page.evaluate(TEXTS)
        assert len(texts) == before
        poor = [words for words, contrast, _ in texts if contrast < TEXT_MIN]
        assert {"wall", "API"} <= set(poor)
        page.evaluate("document.querySelector('#map-in').removeAttribute('aria-label')")
        page.evaluate("document.querySelector('#map-in').textContent = ''")
        with pytest.raises(AssertionError):
            expect(page.locator("#map-in")).to_have_accessible_name(re.compile(r"\w"), timeout=1)


def test_names_on_the_canvases_can_be_read(browser: Browser, server: Server) -> None:
    """On the colour of their zone, whichever it is; and arrows and nodes on their panels."""
    with opened_page(browser, home(server)) as page:
        for theme in THEMES:
            turn(page, theme)
            found = page.evaluate(
                f"""async () => {{ {COLOURS}
                    const {{ colour, shade }} = await import("/viewer/palette.js");
                    const panel = rgba(colour("panel"));
                    return Array.from({{ length: 200 }}, (_, n) => {{
                        const {{ area, line, text }} = shade(n);
                        return [contrast(rgba(text), rgba(area)), contrast(rgba(line), panel)];
                    }});
                }}"""
            )
            assert min(text for text, _ in found) >= TEXT_MIN
            assert min(line for _, line in found) >= MARK_MIN


@pytest.mark.parametrize("state", ["full_list", "dialog", "explored"])
def test_one_sees_where_the_focus_is(browser: Browser, server: Server, state: str) -> None:
    with opened_page(browser, "about:blank", tolerate=TOLERATED) as page:
        STATES[state](page, server)
        if state == "explored":
            page.keyboard.press("Escape")  # the menu of layers
            expect(page.locator("#layer-menu")).to_be_hidden()
        seen = {}
        for _ in range(60):
            page.keyboard.press("Tab")
            for theme in THEMES:
                page.emulate_media(color_scheme=theme)
                focus = page.evaluate(FOCUS)
                if focus["tag"] != "BODY":
                    seen[focus["name"], theme] = focus
        assert len(seen) >= 2 * {"full_list": 5, "dialog": 8, "explored": 25}[state]
        hidden = [it for it in seen.values() if not it["isRing"] or it["contrast"] < MARK_MIN]
        assert hidden == []


def test_the_ring_of_focus_is_drawn(browser: Browser, server: Server) -> None:
    """Nothing covers it, and no panel cuts it off."""
    wanted = {"map", "graph", "time", "drive", "question", "theme", "live", "map-fit"}
    with opened_page(browser, address(server, paper_session(server, 5))) as page:
        shows_step(page, 5, 5)
        page.wait_for_timeout(300)
        for _ in range(40):
            page.keyboard.press("Tab")
            name = page.evaluate("document.activeElement.id")
            if name not in wanted:
                continue
            wanted.remove(name)
            box = page.locator(f"#{name}").bounding_box()
            assert box is not None
            clip = FloatRect(
                x=box["x"] - 5, y=box["y"] - 5, width=box["width"] + 10, height=box["height"] + 10
            )
            with_ring = page.screenshot(clip=clip)
            page.evaluate("document.activeElement.blur()")  # the next Tab goes on from here
            assert page.screenshot(clip=clip) != with_ring, name
    assert wanted == set()

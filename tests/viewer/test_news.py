"""What others do is seen on the page: merged zones, names, closed zones, sessions that begin."""

from __future__ import annotations

from playwright.sync_api import Browser, Page, expect

from tests.servers import Server
from tests.service.test_merging_zones import SESSION, WALK
from tests.service.twin import paper_session
from tests.viewer.browser import opened_page, picture
from tests.viewer.test_page import address, home, passages, shows_step


def zones(page: Page) -> list[str]:
    """Return the zones that the page tells of in its table."""
    tables = page.locator("#tables details")
    if tables.get_attribute("open") is None:
        tables.locator("summary").click()
    expect(tables.locator("table")).to_have_count(2)
    return page.locator("#tables table").first.locator("tbody button").all_inner_texts()


def test_zones_merge_and_are_apart_again_in_the_past(browser: Browser, server: Server) -> None:
    path = server.create(**SESSION)
    for step in WALK[:3]:
        server.step(path, step)
    with opened_page(browser, address(server, path)) as page:
        shows_step(page, 3, 3)
        assert zones(page) == ["h", "o", "o"]
        page.locator("#tables table").first.locator("tbody button").last.click()
        expect(page.locator("#details")).to_contain_text("o-2")
        for step in WALK[3:]:
            server.step(path, step)
        shows_step(page, 6, 6)
        assert zones(page) == ["h", "o"]
        assert {source for source, _ in passages(page)} == {"h", "o"}
        expect(page.locator("#details")).to_contain_text("out,")  # of what it is now part of
        expect(page.locator("#details")).not_to_contain_text("o-2")
        page.locator("#time").fill("4")
        shows_step(page, 4, 6)
        spoken = page.locator("#time").get_attribute("aria-valuetext") or ""
        assert "o-2 is part of o" in spoken
        page.locator("#time").fill("3")
        shows_step(page, 3, 6)
        assert zones(page) == ["h", "o", "o"]
        assert ("h", "o-2") in passages(page)
        picture(page, "before-the-merge")


def test_names_and_closed_zones_of_others_are_told(browser: Browser, server: Server) -> None:
    path = paper_session(server, 81)
    with opened_page(browser, address(server, path), tolerate="409") as page:
        shows_step(page, 81, 81)
        expect(page.locator("#link")).to_have_text("live")
        page.locator("#tables summary").click()
        page.locator("#tables table").first.get_by_role("button", name="A", exact=True).click()
        details = page.locator("#details")
        expect(details).to_contain_text("open")
        notes = {"aliases": ["the lab"], "class": "office"}
        server.client.put(f"{path}/zones/A", json=notes).raise_for_status()
        expect(details).to_contain_text("the lab")
        expect(details).to_contain_text("office")
        shut = {"label": "A", "closed": True, "expires_in": 4}
        server.client.post(f"{path}/restrictions", json=shut).raise_for_status()
        expect(details).to_contain_text("All zones of its label are closed")
        expect(details.locator(".shut").first).to_have_text("closed")
        expect(details.get_by_role("button", name="Close this zone")).to_be_visible()  # it expires
        details.get_by_role("button", name="Close this zone").click()
        expect(details).to_contain_text("closed: no route leads through")
        page.fill("#question", "path from corridor to the lab")
        page.press("#question", "Enter")
        expect(page.locator("#answer")).to_contain_text("closed")
        expect(page.locator("#answer")).not_to_contain_text("missing")  # it is known
        picture(page, "closed-zone")
        details.get_by_role("button", name="Open this zone").click()
        expect(page.locator("#answer")).to_contain_text("Leave corridor")
        expect(details).to_contain_text("open")


def test_sessions_of_others_appear_in_the_list(browser: Browser, server: Server) -> None:
    first = server.create(name="the first of two")
    with opened_page(browser, home(server)) as page:
        cards = page.locator(".card a")
        expect(cards.first).to_have_text("the first of two")
        page.get_by_role("button", name="Delete the first of two").focus()
        server.create(name="the second of two")
        expect(cards.first).to_have_text("the second of two")
        server.step(first, {"pose": {"x": 0, "y": 0}, "scan": SCAN})
        expect(page.locator(".card", has_text="the first of two")).to_contain_text("1 step")
        focused = page.evaluate("document.activeElement.getAttribute('aria-label')")
        assert focused == "Delete the first of two"
        server.client.delete(first).raise_for_status()
        expect(page.get_by_role("link", name="the first of two")).to_have_count(0)


SCAN = {
    "angle_min": 0.0, "angle_increment": 1.57, "range_max": 4.0, "kinds": {},
    "beams": [[["hall", 2.0]]] * 4,
}  # fmt: skip

"""The page, as one who looks at it and uses it: in a real browser, on a real server."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page, expect

from service import key_desk
from tests.plans import Floor
from tests.servers import Json, Server
from tests.service.twin import at, paper_session, paper_steps, paper_world, world_json
from tests.viewer.browser import opened_page, picture

STEPS = paper_steps()
MAP = "#session-view canvas#map"


def home(server: Server) -> str:
    return f"{server.client.base_url}/".replace("//", "/").replace(":/", "://")


def address(server: Server, path: str) -> str:
    """Return where the page shows a session."""
    return f"{home(server)}#/s/{path.rpartition('/')[2]}"


def shows_step(page: Page, seq: int, newest: int) -> None:
    """Wait until the map of a step is shown as it was."""
    expect(page.locator("#moment")).to_have_text(f"{seq} / {newest}")
    expect(page.locator("#session-view")).to_have_attribute("data-exact", "true")


def passages(page: Page) -> set[tuple[str, str]]:
    """Return the passages that the page tells of in its table."""
    tables = page.locator("#tables details")
    if tables.get_attribute("open") is None:
        tables.locator("summary").click()
    expect(tables.locator("table")).to_have_count(2)
    rows = page.locator("#tables table").nth(1).locator("tbody tr").all()
    cells = [row.locator("td").all_inner_texts() for row in rows]
    return {(source, target) for source, target, *_ in cells}


def ask(page: Page, text: str) -> None:
    page.fill("#question", text)
    page.press("#question", "Enter")


def drag_to(page: Page, seq: int, newest: int) -> None:
    """Drag the thumb of the slider to about a step, and the rest of the way by the keys."""
    slider = page.locator("#time")
    box = slider.bounding_box()
    assert box is not None
    left, width, middle = box["x"] + 9, box["width"] - 18, box["y"] + box["height"] / 2
    page.mouse.move(left + width * int(slider.input_value()) / newest, middle)
    page.mouse.down()
    page.mouse.move(left + width * (seq + newest) / 2 / newest, middle, steps=5)
    page.mouse.move(left + width * seq / newest, middle, steps=5)
    page.mouse.up()
    for _ in range(abs(int(slider.input_value()) - seq)):
        page.keyboard.press("ArrowRight" if int(slider.input_value()) < seq else "ArrowLeft")
    assert int(slider.input_value()) == seq


def test_from_nothing_to_the_whole_example(browser: Browser, empty_server: Server) -> None:
    """Open, make the example, drive, and go back in time."""
    with opened_page(browser, home(empty_server)) as page:
        expect(page.get_by_role("heading", name="No map yet")).to_be_visible()
        picture(page, "empty")
        page.get_by_role("button", name="Begin with the example").click()
        expect(page.locator("#map-hint")).to_contain_text("Nothing is explored yet")
        page.get_by_role("button", name="Drive the tour").click()
        shows_step(page, 81, 81)
        every = {(one, other) for room in "ABCD" for one, other in
                 [("corridor", room), (room, "corridor")]}  # fmt: skip
        assert passages(page) == every
        picture(page, "driven")
        drag_to(page, 29, 81)
        shows_step(page, 29, 81)
        assert passages(page) == {("corridor", "A"), ("A", "corridor"), ("C", "corridor")}
        expect(page.locator("#time")).to_have_attribute(
            "aria-valuetext", "Step 29 of 81: found C, C to corridor"
        )
        picture(page, "at-29")
        drag_to(page, 66, 81)
        shows_step(page, 66, 81)
        assert ("corridor", "C") in passages(page)
        page.get_by_role("button", name="Change before").click()
        expect(page.locator("#moment")).not_to_have_text("66 / 81")
        page.get_by_role("button", name="Live").click()
        shows_step(page, 81, 81)
        page.get_by_role("link", name="semtopo: all sessions").click()
        expect(page.locator(".card")).to_have_count(1)


def test_play_goes_through_time_to_live(browser: Browser, server: Server) -> None:
    path = paper_session(server, 81)
    with opened_page(browser, address(server, path)) as page:
        shows_step(page, 81, 81)
        page.locator("#time").fill("60")
        shows_step(page, 60, 81)
        page.get_by_role("button", name="Play").click()
        page.get_by_role("button", name="Pause").click()
        frozen = page.locator("#moment").inner_text()
        assert frozen != "81 / 81"
        page.get_by_role("button", name="Play").click()
        expect(page.locator("#live")).to_have_attribute("aria-pressed", "true")
        shows_step(page, 81, 81)


def test_drive_by_clicking_and_by_keys(browser: Browser, server: Server) -> None:
    path = server.create(world=paper_world())
    with opened_page(browser, address(server, path)) as page:
        expect(page.locator("#map-hint")).to_contain_text("Press Drive")
        page.get_by_role("button", name="Drive").click()
        expect(page.locator("#map-hint")).to_have_text("Click where the robot should begin.")
        box = page.locator(MAP).bounding_box()
        assert box is not None
        page.mouse.click(box["x"] + box["width"] * 0.3, box["y"] + box["height"] * 0.5)
        shows_step(page, 1, 1)
        page.mouse.click(box["x"] + box["width"] * 0.3, box["y"] + box["height"] * 0.3)
        expect(page.locator("#moment")).not_to_have_text("1 / 1")
        expect(page.locator("#session-view")).to_have_attribute("data-moving", "false")
        before = read(server, path)["seq"]
        assert before > 2
        page.keyboard.press("ArrowUp")
        expect(page.locator("#moment")).to_have_text(f"{before + 1} / {before + 1}")
        page.keyboard.press("d")
        expect(page.locator("#moment")).to_have_text(f"{before + 2} / {before + 2}")
        poses = json.loads(server.get(f"{path}/trail"))["poses"]
        (x0, y0, _), (x1, y1, _), (x2, y2, _) = poses[-3:]
        assert (x1, y1) == pytest.approx((x0, y0 + 0.25))
        assert (x2, y2) == pytest.approx((x1 + 0.25, y1))
        picture(page, "driving")


def read(server: Server, path: str) -> Json:
    body: Json = json.loads(server.get(path))
    return body


@pytest.mark.parametrize(
    ("news", "exact"), [([], True), ([{"type": "edge"}], False)], ids=["quiet", "news"]
)
def test_a_map_that_came_before_its_step_is_exact_only_with_its_graph(
    browser: Browser, server: Server, news: list[Json], *, exact: bool
) -> None:
    """The map of step 29 was read before that step was told; its graph is still to come."""
    with opened_page(browser, home(server)) as page:
        told = page.evaluate(
            """async (events) => {
                const { Session } = await import("/viewer/session.js");
                const session = new Session("robot");
                const graph = { ...session.state.graph, seq: 28 };
                const changes = [{ seq: 28, events: [{ type: "node" }] }];
                session.store.set({ seq: 28, moment: { seq: 29, zones: [] }, graph, changes });
                session.refresh = async () => {};
                session.stepped({ seq: 29, pose: { x: 0, y: 0, theta: 0 }, events });
                return session.state.exact;
            }""",
            news,
        )
        assert told is exact


def test_who_goes_live_sees_no_earlier_map_as_exact(browser: Browser, server: Server) -> None:
    with opened_page(browser, home(server)) as page:
        told = page.evaluate(
            """async () => {
                const { Session } = await import("/viewer/session.js");
                const session = new Session("robot");
                session.store.set({ seq: 29, at: 5, moment: { seq: 5, zones: [] }, exact: true });
                session.refresh = async () => {};
                session.go(null);
                return session.state.exact;
            }"""
        )
        assert told is False


def test_follow_a_robot_that_someone_else_drives(browser: Browser, server: Server) -> None:
    path = paper_session(server, 4)
    with opened_page(browser, address(server, path)) as page:
        expect(page.locator("#link")).to_have_text("live")
        shows_step(page, 4, 4)
        for step in STEPS[4:29]:
            server.step(path, step)
        shows_step(page, 29, 29)
        assert passages(page) == {("corridor", "A"), ("A", "corridor"), ("C", "corridor")}
        page.locator("#time").fill("5")
        shows_step(page, 5, 29)
        for step in STEPS[29:66]:
            server.step(path, step)
        shows_step(page, 5, 66)  # who looks at the past is left there
        assert passages(page) == {("corridor", "A")}


def test_the_line_is_taken_up_again(browser: Browser, empty_server: Server) -> None:
    path = paper_session(empty_server, 4)
    with opened_page(browser, address(empty_server, path), tolerate=r"ERR_|Failed to load") as page:
        shows_step(page, 4, 4)
        empty_server.stop()
        expect(page.locator("#link")).to_have_text("reconnecting")
        empty_server.start()
        for step in STEPS[4:10]:
            empty_server.step(path, step)
        shows_step(page, 10, 10)
        expect(page.locator("#link")).to_have_text("live")


def test_ask_and_be_refused_then_answered(browser: Browser, server: Server) -> None:
    path = paper_session(server, 29)
    with opened_page(browser, address(server, path), tolerate="409|422") as page:
        shows_step(page, 29, 29)
        ask(page, "path from corridor to C")
        answer = page.locator("#answer")
        expect(answer).to_contain_text("no way from corridor to C")
        expect(answer).to_have_class(re.compile("refused"))
        expect(answer).to_contain_text("green ring on the map marks the frontier")
        expect(answer).to_contain_text("dashed arrow is the passage that is missing")
        picture(page, "refused")
        ask(page, "colourless green ideas")
        expect(answer).to_contain_text("Expected")
        page.locator("#answer button").first.click()  # the example that it offers
        for step in STEPS[29:66]:
            server.step(path, step)
        shows_step(page, 66, 66)
        ask(page, "path from corridor to C")
        expect(answer).to_contain_text("Leave corridor at (8.9, 4.3) into C")
        expect(answer).not_to_have_class(re.compile("refused"))
        picture(page, "answered")
        page.get_by_role("button", name="Clear").click()
        expect(answer).to_be_empty()


def test_a_closed_passage_changes_the_route(browser: Browser, server: Server) -> None:
    """From one link of a floor to the other leads the south corridor, or else the north one."""
    floor = Floor(2)
    path = server.create(
        world=world_json(floor.world), sensor={"range": 4.0, "samples": 40},
        mapping={"edges": "adjacent"},
    )  # fmt: skip
    for x, y in floor.path():
        server.step(path, at(x, y))
    with opened_page(browser, address(server, path)) as page:
        expect(page.locator("#session-view")).to_have_attribute("data-exact", "true")
        answer = page.locator("#answer")
        ask(page, "path from west to east")
        expect(answer).to_contain_text(re.compile(r"west → (south|north) → east"))
        expect(answer).to_contain_text("keeps 0.1")
        first = "south" if "south" in answer.inner_text() else "north"
        other = {"south": "north", "north": "south"}[first]
        page.locator("#tables summary").click()
        page.locator("#tables table").first.get_by_role("button", name="west", exact=True).click()
        page.get_by_role("button", name=f"Close west → {first}").click()
        expect(answer).to_contain_text(f"west → {other} → east")
        expect(page.locator("#details .shut")).to_have_text("closed")
        picture(page, "closed")
        page.get_by_role("button", name=f"Open west → {first}").click()
        expect(answer).to_contain_text(f"west → {first} → east")
        expect(page.locator("#details .shut")).to_have_count(0)
        others = server.client.post(
            f"{path}/restrictions",
            json={"passage": {"source": "west", "target": first}, "closed": True},
        )
        assert others.status_code == 201
        expect(answer).to_contain_text(f"west → {other} → east")  # somebody else closed it


def test_a_robot_has_a_radius_and_may_go_both_ways(browser: Browser, server: Server) -> None:
    path = paper_session(server, 29)  # C was left for the corridor, and never entered from there
    with opened_page(browser, address(server, path), tolerate="409") as page:
        shows_step(page, 29, 29)
        answer = page.locator("#answer")
        ask(page, "path from corridor to C")
        expect(answer).to_have_class(re.compile("refused"))
        answer.get_by_role("button", name="Use passages both ways").click()
        expect(answer).to_contain_text("against the direction in which it is known")
        expect(answer).to_contain_text(
            "No path is drawn: no ground is known between C and corridor"
        )
        expect(page.locator("#two-way")).to_have_attribute("aria-pressed", "true")
        page.get_by_role("button", name="Passages both ways", exact=True).click()
        expect(answer).to_have_class(re.compile("refused"))
        for step in STEPS[29:66]:
            server.step(path, step)
        shows_step(page, 66, 66)
        ask(page, "path from corridor to C")
        expect(answer).to_contain_text("The path keeps 0.1")
        for radius, words in (("0.3", "The path keeps 0.3"), ("3", "No path is drawn"), ("", "·")):
            page.get_by_label("Radius, m").fill(radius)
            page.get_by_label("Radius, m").press("Enter")
            expect(answer).to_contain_text(words)
            expect(answer).not_to_have_class(re.compile("refused"))
            picture(page, f"radius-{radius or 'none'}")
        expect(answer).not_to_contain_text("The path")
        expect(answer).not_to_contain_text("No path")


def test_map_and_graph_are_linked(browser: Browser, server: Server) -> None:
    path = paper_session(server, 81)
    with opened_page(browser, address(server, path)) as page:
        shows_step(page, 81, 81)
        page.locator("#tables summary").click()
        page.locator("#tables table").first.get_by_role("button", name="B", exact=True).click()
        details = page.locator("#details")
        expect(details).to_contain_text("at step 42")
        expect(details.get_by_role("button", name="corridor → B", exact=True)).to_be_visible()
        before = [page.locator(name).screenshot() for name in (MAP, "canvas#graph")]
        details.get_by_role("button", name="B → corridor", exact=True).hover()
        page.wait_for_timeout(200)
        after = [page.locator(name).screenshot() for name in (MAP, "canvas#graph")]
        assert before[0] != after[0]
        assert before[1] != after[1]
        details.get_by_role("button", name="B → corridor", exact=True).click()
        expect(details).to_contain_text("at step 43")
        picture(page, "selected")


def test_labels_are_text_whatever_they_say(browser: Browser, server: Server) -> None:
    label = "<img src=x onerror=alert(1)><script>document.title='owned'</script>"
    scan = {"angle_min": 0.0, "angle_increment": 1.57, "range_max": 4.0, "kinds": {}}
    path = server.create(name=label)
    server.step(path, at(0, 0, 0, {**scan, "beams": [[[label, 2.0]]] * 4}))
    with opened_page(browser, address(server, path)) as page:
        shows_step(page, 1, 1)
        page.locator("#tables summary").click()
        page.locator("#tables button").first.click()
        expect(page.locator("#details")).to_contain_text(label)
        assert page.title() == f"{label} \N{MIDDLE DOT} semtopo"
        page.goto(home(server))
        expect(page.get_by_role("link", name=label)).to_be_visible()
        assert page.locator("#content img, #content script").count() == 0


def test_a_world_from_a_file(browser: Browser, server: Server, tmp_path: Path) -> None:
    good, bad = tmp_path / "good.json", tmp_path / "bad.json"
    zone = {"label": "hall", "kind": "space", "low": [0, 0], "high": [5, 4]}
    good.write_text(json.dumps({"name": "a hall", "zones": [zone]}))
    bad.write_text(json.dumps({"name": "a hall", "zones": [{**zone, "high": [5, 0]}]}))
    with opened_page(browser, home(server), tolerate="422") as page:
        page.get_by_role("button", name="New session").click()
        page.get_by_label("In a world of mine").check()
        page.set_input_files("#world-file", bad)
        picture(page, "new-session")
        page.get_by_role("button", name="Create").click()
        expect(page.locator("#new-problem")).to_contain_text("low must be below high")
        page.set_input_files("#world-file", good)
        page.get_by_role("button", name="Create").click()
        expect(page.locator("#title")).to_have_text("a hall")
        expect(page.locator("#details")).to_contain_text("72 beams")


def test_a_real_robot_is_told_what_to_send(browser: Browser, server: Server) -> None:
    with opened_page(browser, home(server)) as page:
        page.get_by_role("button", name="New session").click()
        page.get_by_label("In a real building").check()
        page.fill("#new-name", "my robot")
        page.get_by_role("button", name="Create").click()
        expect(page.locator("#title")).to_have_text("my robot")
        expect(page.get_by_role("button", name="Drive")).to_be_hidden()
        command = page.locator("#details pre").inner_text()
        body = re.search(r"--json '(.*)'", command, re.DOTALL)
        assert body is not None
        path = "/sessions/" + page.url.rpartition("/")[2]
        server.step(path, json.loads(body[1]))
        shows_step(page, 1, 1)


def test_a_session_is_deleted_at_the_second_click(browser: Browser, server: Server) -> None:
    path = server.create(name="of no use")
    with opened_page(browser, home(server)) as page:
        button = page.get_by_role("button", name="Delete of no use")
        button.click()
        assert server.client.get(path).status_code == 200
        button.click()
        expect(page.get_by_role("link", name="of no use")).to_have_count(0)
        assert server.client.get(path).status_code == 404


def test_a_session_that_is_not_there_leads_to_the_list(browser: Browser, server: Server) -> None:
    server.create(name="one that is there")
    with opened_page(browser, address(server, "/sessions/nothing"), tolerate="404") as page:
        expect(page.get_by_role("alert").filter(has_text="no session of that id")).to_be_visible()
        expect(page.get_by_role("link", name="one that is there")).to_be_visible()


def test_a_session_that_is_deleted_says_so(browser: Browser, server: Server) -> None:
    path = paper_session(server, 5)
    with opened_page(browser, address(server, path)) as page:
        shows_step(page, 5, 5)
        expect(page.locator("#link")).to_have_text("live")
        server.client.delete(path).raise_for_status()
        expect(page.locator("#link")).to_have_text("ended")
        expect(page.get_by_role("alert").filter(has_text="deleted")).to_be_visible()


def test_a_key_is_asked_for_and_sent(browser: Browser, tmp_path: Path) -> None:
    server = Server(tmp_path / "guarded", keys=True)
    server.start()
    bearer = {"Authorization": f"Bearer {(key := key_desk.add(server.url, 'page'))}"}
    made = server.client.post("/sessions", json={"world": paper_world()}, headers=bearer)
    path = made.headers["Location"]
    server.step(path, STEPS[0], bearer)
    with opened_page(browser, address(server, path), tolerate="401") as page:
        page.get_by_label("API key").fill(key)
        page.get_by_role("button", name="Use it").click()
        shows_step(page, 1, 1)
        expect(page.locator("#link")).to_have_text("live")
        server.step(path, STEPS[1], bearer)
        shows_step(page, 2, 2)
    server.close()
    assert server.faults() == []

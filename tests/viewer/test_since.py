"""While a robot drives, the page reads only what changed, and shows what the whole map shows."""

from __future__ import annotations

import json

import pytest
from playwright.sync_api import Browser, Page, Request, expect

from tests.servers import Json, Server
from tests.service.test_merging_zones import SESSION, WALK
from tests.service.twin import at, paper_session, paper_steps, paper_world
from tests.viewer.browser import opened_page
from tests.viewer.test_page import address, passages, shows_step

COUNT = 130
"""Rooms in a row: of so many, walls are read only for those in sight."""

PARTS = ("zones", "graph", "borders", "doorways")

FOLLOW = """async (path) => {
    const { Moments } = await import("/viewer/moments.js");
    const { Walls } = await import("/viewer/walls.js");
    const { graphOf } = await import("/viewer/model.js");
    const { graphAfter } = await import("/viewer/since.js");
    const get = async (rest) => (await fetch(path + rest)).json();
    const shape = ({ zones, seq }) => [seq, zones.map(({ id, label, rings, seq }) =>
        [id, label, rings, seq])];
    const graphShape = ({ nodes, edges, seq }) => [seq, nodes, edges];
    const follower = new Moments(get);
    const walls = new Walls(get, () => {});
    let graph = graphOf(await get("/graph"));
    window.follower = {
        async compare() {
            const read = await follower.readNewest();
            await walls.read(read, new URLSearchParams(), 0, undefined);
            const body = await get(`/graph?since=${graph.seq}`);
            graph = graphAfter(graph, body) ?? graphOf(await get("/graph"));
            const fresh = new Walls(get, () => {});
            await fresh.read(read, new URLSearchParams(), 0, undefined);
            const named = (all) => all.map(({ name, since, box }) => [name, since, box]).sort();
            return {
                followed: [shape(read), graphShape(graph), named(walls.doorways)],
                whole: [shape(await new Moments(get).read("")),
                        graphShape(graphOf(await get("/graph"))), named(fresh.doorways)],
                walls: read.zones.every((zone) => walls.of(zone) && fresh.of(zone)),
            };
        },
    };
}"""


def recorded(page: Page) -> list[str]:
    """Return the list in which the addresses of what the page asks for are kept from now on."""
    asked: list[str] = []

    def keep(request: Request) -> None:
        path = request.url.split("/sessions/")[-1].partition("/")[2]
        if path.partition("?")[0] in PARTS:
            asked.append(path)

    page.on("request", keep)
    return asked


def row_of_rooms() -> Json:
    rooms = [
        {"label": f"room {n}", "kind": "space", "low": [3 * n, 0], "high": [3 * n + 2.75, 3]}
        for n in range(COUNT)
    ]
    doors = [
        {"label": "door", "kind": "passage", "low": [3 * n + 2.75, 1], "high": [3 * n + 3, 2]}
        for n in range(COUNT - 1)
    ]
    return {"name": "a row", "zones": [*rooms, *doors]}


@pytest.fixture(scope="module")
def row(page_server: Server) -> str:
    """Give a session in which a robot has seen all rooms of a row but the last two."""
    path = page_server.create(
        world=row_of_rooms(), sensor={"range": 4.0, "beams": 36, "samples": 20},
        mapping={"edges": "adjacent"},
    )  # fmt: skip
    for n in range(COUNT - 3):
        page_server.step(path, at(3 * n + 1.4, 1.5))
    return path


def test_only_what_changed_is_read(browser: Browser, server: Server, row: str) -> None:
    before = json.loads(server.get(row))["seq"]
    with opened_page(browser, address(server, row)) as page:
        shows_step(page, before, before)
        expect(page.locator("#link")).to_have_text("live")
        asked = recorded(page)
        for n in range(COUNT - 3, COUNT):
            for x in (3 * n + 0.7, 3 * n + 1.4):
                server.step(row, at(x, 1.5))
        shows_step(page, before + 6, before + 6)
        expect(page.locator("#details")).to_contain_text(f"{COUNT} zones")
        passages(page)
        expect(page.locator("#tables caption").nth(1)).to_have_text("Passages (200 of 258)")
        page.get_by_role("button", name="Show more rows").click()
        expect(page.locator("#tables caption").nth(1)).to_have_text("Passages (258)")
        assert ("room 128", "room 129") in passages(page)
        assert {path.partition("?")[0] for path in asked} == set(PARTS)
        assert asked.count("zones") == 0
        assert asked.count("graph") <= 1  # once more when it opens, for what is closed
        for part in ("zones", "graph"):
            whole = len(server.get(f"{row}/{part}"))
            queries = [it for it in asked if it.startswith(f"{part}?since=")]
            assert queries
            sizes = {it: len(server.client.get(f"{row}/{it}").content) for it in queries}
            assert {query: it for query, it in sizes.items() if it > whole / 4} == {}


@pytest.mark.parametrize("run", ["paper", "merging"])
def test_what_is_followed_is_the_whole_map(browser: Browser, server: Server, run: str) -> None:
    """After every step, also one that merges zones; and after several at once."""
    session, steps = {
        "paper": ({"world": paper_world()}, paper_steps()),
        "merging": (SESSION, WALK),
    }[run]
    path = server.create(**session)
    with opened_page(browser, f"{server.client.base_url}/") as page:
        page.evaluate(FOLLOW, path)
        asked = recorded(page)
        every = 1 if run == "merging" else 9
        for first in range(0, len(steps), every):
            for step in steps[first : first + every]:
                server.step(path, step)
            found = page.evaluate("window.follower.compare()")
            assert found["followed"] == found["whole"]
            assert found["walls"]
        assert found["followed"][0][0] == len(steps)
        assert sum("since=" in path for path in asked) >= 4 * (len(steps) // every - 2)


def test_another_log_is_read_as_a_whole(browser: Browser, server: Server) -> None:
    """Where a step that was known is none of the log, all is read anew."""
    longer, shorter = paper_session(server, 40), paper_session(server, 12)
    with opened_page(browser, f"{server.client.base_url}/", tolerate="404") as page:
        found = page.evaluate(
            """async ([longer, shorter]) => {
                const { Problem, getJson } = await import("/viewer/api.js");
                const { Moments } = await import("/viewer/moments.js");
                let path = longer;
                const moments = new Moments((rest, signal) => getJson(path + rest, signal));
                const first = await moments.readNewest();
                path = shorter;
                const then = await moments.readNewest();
                return [first, then].map(({ seq, zones }) => [seq, zones.map(({ seq }) => seq)]);
            }""",
            [longer, shorter],
        )
    assert [seq for seq, _ in found] == [40, 12]
    zones = json.loads(server.get(f"{shorter}/zones"))["features"]
    assert found[1][1] == [zone["properties"]["seq"] for zone in zones]

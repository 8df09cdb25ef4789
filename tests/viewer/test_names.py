"""Names on the map, and nodes of the graph: where there is room for them, and off each other."""

from __future__ import annotations

import json
import random
from math import cos, pi, sin
from typing import Any

import pytest
import shapely
from playwright.sync_api import Browser, Page
from shapely.affinity import rotate, translate
from shapely.geometry.base import BaseGeometry

from tests.plans import Floor
from tests.servers import Json, Server
from tests.service.twin import at, paper_session, world_json
from tests.viewer.browser import opened_page, picture
from tests.viewer.test_page import address, home, shows_step

Drawn = dict[str, Any]
"""A name that was drawn: its words, its middle in pixels, its angle on the screen, its size."""

LEAST = 11  # pixels, of a name

DRAW = """async ([body, query]) => {
    const { zonesOf } = await import("/viewer/model.js");
    const { Camera } = await import("/viewer/camera.js");
    const { drawLabels } = await import("/viewer/labels.js");
    const { growBox, noBox } = await import("/viewer/geometry.js");
    const zones = zonesOf(body, new Map(), new Map());
    const camera = new Camera();
    camera.resize(query.width, query.height);
    camera.fit(growBox(noBox(), zones.flatMap(({ box: [a, b, c, d] }) => [[a, b], [c, d]])));
    const real = document.createElement("canvas").getContext("2d");
    let now = [0, 0, 0];
    const drawn = [];
    const context = {
        save() {}, restore() { now = [0, 0, 0]; }, strokeText() {},
        translate(x, y) { now[0] += x; now[1] += y; },
        rotate(angle) { now[2] += angle; },
        measureText(words) { real.font = context.font; return real.measureText(words); },
        fillText(words) {
            real.font = context.font;
            drawn.push({
                words, x: now[0], y: now[1], angle: now[2], width: real.measureText(words).width,
                size: parseFloat(context.font.match(/([\\d.]+)px/)[1]),
            });
        },
    };
    drawLabels(context, camera, zones, { marks: query.marks, sight: query.sight ?? null });
    const onScreen = (points) => points.map((it) => camera.toScreen(...it));
    return [drawn, onScreen(query.marks), zones.map((zone) => zone.rings.map(onScreen))];
}"""


def names_on(
    page: Page, zones: Json, size: tuple[int, int], marks: list[list[float]], **more: object
) -> tuple[list[Drawn], list[list[float]], list[shapely.Polygon]]:
    """Return the names that are drawn on a map; marks and zones, in pixels too."""
    query = {"width": size[0], "height": size[1], "marks": marks, **more}
    drawn, on_screen, shapes = page.evaluate(DRAW, [zones, query])
    return drawn, on_screen, [shapely.Polygon(outer, holes) for outer, *holes in shapes]


def outline(name: Drawn) -> BaseGeometry:
    """Return where the letters of a name are, from the least to the greatest of them."""
    half, up = name["width"] / 2, name["size"] * 0.36
    box = rotate(shapely.box(-half, -up, half, up), name["angle"], origin=(0, 0), use_radians=True)
    place: BaseGeometry = translate(box, name["x"], name["y"])
    return place


@pytest.fixture(scope="module")
def floor(page_server: Server) -> str:
    """Give a session of the floor with 32 rooms, in which every room is known."""
    plan = Floor()
    path = page_server.create(
        world=world_json(plan.world), name="floor",
        sensor={"range": 4.0, "samples": 40}, mapping={"edges": "adjacent"},
    )  # fmt: skip
    for x, y in plan.path():
        page_server.step(path, at(x, y))
    return path


def feature(zone_id: str, shape: BaseGeometry) -> Json:
    about = {"label": zone_id, "area": shape.area, "since": 1, "seq": 1}
    geometry = json.loads(shapely.to_geojson(shapely.orient_polygons(shape)))
    return {"type": "Feature", "id": zone_id, "properties": about, "geometry": geometry}


def shapes(count: int) -> list[tuple[BaseGeometry, float, float]]:
    """Return polygons of several kinds, turned, and the width and height of a name for each."""
    draw = random.Random(29)
    found = []
    for n in range(count):
        across, up = draw.uniform(2, 20), draw.uniform(0.6, 3)
        kinds = [
            shapely.box(0, 0, across, up),
            shapely.box(0, 0, across, across) - shapely.box(up, up, across, across),  # an L
            shapely.box(0, 0, across + 2 * up, across + 2 * up)
            - shapely.box(up, up, across + up, across + up),  # a ring
            shapely.Polygon([
                (draw.uniform(4, 9) * cos(turn * pi / 8), draw.uniform(4, 9) * sin(turn * pi / 8))
                for turn in range(16)
            ]),
        ]  # fmt: skip
        shape = rotate(kinds[n % 4], draw.choice([0, 90, draw.uniform(0, 180)]), origin=(0, 0))
        found.append((shape, draw.uniform(0.5, 4), draw.uniform(0.3, 0.6)))
    return found


def test_a_name_is_written_only_where_it_fits(browser: Browser, server: Server) -> None:
    cases = shapes(200)
    asked = [
        {"zone": feature("a", shape), "width": width, "height": height}
        for shape, width, height in cases
    ]
    with opened_page(browser, home(server)) as page:
        found = page.evaluate(
            """async (cases) => {
                const { slotsFor } = await import("/viewer/slots.js");
                const { zonesOf } = await import("/viewer/model.js");
                return cases.map(({ zone, width, height }) => [true, false].map((all) => slotsFor(
                    zonesOf({ features: [zone] }, new Map(), new Map())[0], width, height, all)));
            }""",
            asked,
        )
    outside, turned = [], 0
    for (shape, width, height), (slots, best) in zip(cases, found, strict=True):
        assert best[:1] == slots[:1]
        assert [slot["off"] for slot in slots] == sorted(slot["off"] for slot in slots)
        for slot in slots:
            box = shapely.box(-width / 2, -height / 2, width / 2, height / 2)
            place = rotate(box, slot["angle"], origin=(0, 0), use_radians=True)
            missed = translate(place, slot["x"], slot["y"]) - shape
            outside.append(missed.area / place.area)
        turned += bool(slots) and slots[0]["angle"] != 0
    assert max(outside) < 0.15  # a corner of the name, in which no letter is
    assert sum(outside) / len(outside) < 0.01
    named = sum(bool(slots) for slots, _ in found)
    assert 100 < named < 200  # some are too small
    assert turned > 10


def test_a_zone_that_has_room_has_its_name(browser: Browser, server: Server) -> None:
    """Boxes that are larger than the name are named: level if they can be, else turned."""
    wide = [(shapely.box(0, 0, 3.0, 1.0), 0.0), (shapely.box(0, 0, 1.0, 3.0), pi / 2)]
    wide += [(rotate(wide[0][0], angle, use_radians=True), angle) for angle in (-1.2, -0.7, 0.7)]
    asked = [feature("a", shape) for shape, _ in wide]
    with opened_page(browser, home(server)) as page:
        found = page.evaluate(
            """async (zones) => {
                const { slotsFor } = await import("/viewer/slots.js");
                const { zonesOf } = await import("/viewer/model.js");
                return zones.map((zone) => slotsFor(
                    zonesOf({ features: [zone] }, new Map(), new Map())[0], 2, 0.5, false)[0]);
            }""",
            asked,
        )
    for slot, (shape, angle) in zip(found, wide, strict=True):
        assert slot["angle"] == pytest.approx(angle, abs=1e-6)
        middle = shapely.Point(slot["x"], slot["y"])
        assert middle.distance(shape.centroid) < 0.5


@pytest.mark.parametrize("size", [(366, 460), (746, 608), (1100, 1230)])
def test_all_names_of_a_floor_are_legible(
    browser: Browser, server: Server, floor: str, size: tuple[int, int]
) -> None:
    zones = json.loads(server.get(f"{floor}/zones"))
    with opened_page(browser, home(server)) as page:
        drawn, _, _ = names_on(page, zones, size, [])
    assert len(drawn) == len(zones["features"]) == 36
    assert all(name["size"] >= LEAST for name in drawn)
    places = [outline(name) for name in drawn]
    tree = shapely.STRtree(places)
    covering = [(a, b) for a, b in tree.query(places, predicate="intersects").T if a < b]
    assert covering == []


def test_no_name_is_under_the_robot_or_a_route(browser: Browser, server: Server) -> None:
    zones = json.loads(server.get(f"{paper_session(server, 81)}/zones"))
    middles = [shapely.geometry.shape(it["geometry"]).representative_point() for it in
               zones["features"]]  # fmt: skip
    with opened_page(browser, home(server)) as page:
        plain, _, _ = names_on(page, zones, (746, 608), [])
        before = {name["words"]: (name["x"], name["y"]) for name in plain}
        for middle in middles:
            marks = [[middle.x, middle.y]]
            drawn, seen, regions = names_on(page, zones, (746, 608), marks)
            assert {name["words"] for name in drawn} == set(before) == {"corridor", *"ABCD"}
            for name in drawn:
                mark = shapely.Point(seen[0]).buffer(9)
                assert not outline(name).intersects(mark)
                assert max(outline(name).intersection(it).area for it in regions) > 0.9 * (
                    outline(name).area
                )
        sight = [middles[0].x - 2, middles[0].y - 2, middles[0].x + 2, middles[0].y + 2]
        drawn, _, _ = names_on(page, zones, (746, 608), [], sight=sight)
        moved = [it for it in drawn if (it["x"], it["y"]) != before[it["words"]]]
        assert len(moved) <= 1  # only that of the zone with the beams


def test_names_stay_where_they_are_while_the_view_moves(browser: Browser, server: Server) -> None:
    """The same place on the map, however far the camera has gone."""
    zones = json.loads(server.get(f"{paper_session(server, 40)}/zones"))
    with opened_page(browser, home(server)) as page:
        first, _, _ = names_on(page, zones, (746, 608), [])
        again, _, _ = names_on(page, zones, (746, 608), [])
    assert first == again
    assert len(first) > 2


def test_nodes_of_the_graph_do_not_cover_each_other(browser: Browser, server: Server) -> None:
    draw = random.Random(7)
    crowds: list[list[Json]] = []
    for count in (1, 2, 15, 15, 60, 300):
        places = [(draw.uniform(0, 60), draw.uniform(0, 24)) for _ in range(count)]
        crowds.append([feature(f"room-{n}", shapely.box(x, y, x + 3, y + 3))
                       for n, (x, y) in enumerate(places)])  # fmt: skip
    with opened_page(browser, home(server)) as page:
        laid = page.evaluate(
            """async (crowds) => {
                const { layOut, HALF_HEIGHT } = await import("/viewer/graphlayout.js");
                const { zonesOf } = await import("/viewer/model.js");
                return crowds.map((features) => {
                    const zones = zonesOf({ features }, new Map(), new Map());
                    const byId = new Map(zones.map((zone) => [zone.id, zone]));
                    const placed = layOut(zones, byId, (words) => 8 * words.length, 860, 1220);
                    return [...placed.values()].map(({ x, y, half }) =>
                        [x - half, y - HALF_HEIGHT, x + half, y + HALF_HEIGHT]);
                });
            }""",
            crowds,
        )
    for crowd, boxes in zip(crowds, laid, strict=True):
        assert len(boxes) == len(crowd)
        nodes = [shapely.box(*box) for box in boxes]
        found = shapely.STRtree(nodes).query(nodes, predicate="intersects").T
        assert [(a, b) for a, b in found if a < b] == []
    for boxes in laid[2:4]:  # so few are drawn larger on a wall screen
        left, low = (min(box[n] for box in boxes) for n in (0, 1))
        right, high = (max(box[n] for box in boxes) for n in (2, 3))
        assert min(860 / (right - left), 1220 / (high - low)) > 1.4


def test_a_wide_map_is_above_its_graph_on_a_wall_screen(browser: Browser, server: Server) -> None:
    corridor = server.create(world={
        "name": "long", "zones": [{"label": "c", "kind": "space", "low": [0, 0], "high": [20, 2]}],
    })  # fmt: skip
    for x in range(1, 19, 2):
        server.step(corridor, at(x, 1.0))
    paper = paper_session(server, 81)
    for path, is_wide, seq in ((corridor, True, 9), (paper, False, 81)):
        with opened_page(browser, address(server, path), width=2560, height=1440) as page:
            shows_step(page, seq, seq)
            page.wait_for_timeout(300)
            picture(page, f"wall-{'wide' if is_wide else 'square'}")
            above, beside = (page.locator(f".{it}-panel").bounding_box() for it in ("map", "graph"))
            assert above is not None
            assert beside is not None
            assert (beside["y"] > above["y"] + above["height"]) == is_wide
            assert (beside["x"] > above["x"] + above["width"]) == (not is_wide)
    with opened_page(browser, address(server, corridor), width=1280) as page:
        shows_step(page, 9, 9)
        side = page.locator(".graph-panel").bounding_box()
        assert side is not None
        assert side["x"] > 640  # elsewhere the graph stays beside the map

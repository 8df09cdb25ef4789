"""Pictures over HTTP: those of the library, of the size asked for, and never in anybody's way."""

from __future__ import annotations

import asyncio
import io
import threading
import time
from collections.abc import Callable

import httpx2
import numpy as np
import pytest
from PIL import Image

from semtopo.atlas import Atlas
from semtopo.render import render
from semtopo.render.drawing import (
    ALL_LAYERS,
    Drawing,
    DrawnRoute,
    Layer,
    thinned_trail,
    trail_stride,
)
from semtopo.render.palette import FONTS
from semtopo.route import Place, RouteRequest, find_routes
from service import painter as painters
from service import store
from service.database import open_database
from service.errors import BusyError, PictureError
from service.painter import PAINTERS, WAITING_MAX, Painter
from service.painting import png_of
from service.routes.sessions import new_session
from service.routes.steps import step_request
from service.schemas.sessions import SessionRequest
from service.schemas.steps import StepDocument
from service.store import LoggedStep
from tests.plans import Floor
from tests.servers import Server
from tests.service.twin import Twin, at, paper_steps, paper_world, world_json

pytestmark = pytest.mark.databases("sqlite", "postgres")

TRAIL = [(step["pose"]["x"], step["pose"]["y"]) for step in paper_steps()]


@pytest.fixture(scope="module")
def twin() -> Twin:
    """Give the paper's run in the library."""
    return Twin.driven({"world": paper_world()}, paper_steps())


@pytest.fixture(scope="module")
def session(lasting_server: Server, twin: Twin) -> str:
    """Give the paper's run on a server."""
    path = lasting_server.create(**twin.session)
    for document in paper_steps():
        lasting_server.step(path, document)
    return path


def image(png: bytes) -> Image.Image:
    picture = Image.open(io.BytesIO(png))
    assert picture.format == "PNG"
    picture.load()
    return picture


@pytest.mark.parametrize("seq", [0, 1, 29, 81])
def test_an_svg_is_that_of_the_library(server: Server, session: str, twin: Twin, seq: int) -> None:
    expected = render(twin.states[seq], Drawing(trail=TRAIL[:seq]))
    answer = server.client.get(f"{session}/map.svg", params={"at": seq})
    assert answer.headers["Content-Type"].startswith("image/svg+xml")
    assert answer.text == expected
    if seq == twin.seq:
        assert server.get(f"{session}/map.svg").decode() == expected


def test_size_and_layers_are_as_asked(server: Server, session: str, twin: Twin) -> None:
    shown = server.get(f"{session}/map.svg", width=600, height=500, layers="graph,frontiers,zones")
    layers = frozenset({Layer.GRAPH, Layer.FRONTIERS, Layer.ZONES})
    assert shown.decode() == render(
        twin.states[-1], Drawing(trail=TRAIL, layers=layers, width=600, height=500)
    )


def test_a_route_is_drawn(server: Server, session: str, twin: Twin) -> None:
    shown = server.get(f"{session}/map.svg", **{"from": "A", "to": "b", "at": 50})
    request = RouteRequest(start=Place("A"), goals=(Place("B"),))
    route = find_routes(Atlas(twin.states[50]), request)[0]
    drawn = DrawnRoute(route.points, frozenset(passage.key for passage in route.passages))
    assert shown.decode() == render(twin.states[50], Drawing(trail=TRAIL[:50], route=drawn))
    assert len(route.passages) == 2


def test_with_a_radius_the_path_is_drawn(server: Server, session: str, twin: Twin) -> None:
    shown = server.get(f"{session}/map.svg", **{"from": "A", "to": "b", "radius": 0.2})
    request = RouteRequest(start=Place("A"), goals=(Place("B"),), radius=0.2)
    route = find_routes(Atlas(twin.states[-1]), request)[0]
    assert route.path is not None
    assert len(route.path.points) > len(route.points)
    drawn = DrawnRoute(route.path.points, frozenset(it.key for it in route.passages))
    assert shown.decode() == render(twin.states[-1], Drawing(trail=TRAIL, route=drawn))


def test_the_route_that_is_asked_for_is_drawn(server: Server, session: str, twin: Twin) -> None:
    """On the way from A to B by C, the corridor is left where it is not left otherwise."""
    asked = "from=A&to=B&via=C&two_way=true&avoid=D&avoid="
    shown = server.client.get(f"{session}/map.svg?{asked}corridor->A").text
    request = RouteRequest(
        start=Place("A"), goals=(Place("B"),), via=("C",), avoid_zones=frozenset({"D"}),
        avoid_passages=frozenset({("corridor", "A", 0)}), two_way=True,
    )  # fmt: skip
    route = find_routes(Atlas(twin.states[-1]), request)[0]
    assert "C" in route.zones
    drawn = DrawnRoute(route.points, frozenset(passage.key for passage in route.passages))
    assert shown == render(twin.states[-1], Drawing(trail=TRAIL, route=drawn))
    plain = server.get(f"{session}/map.svg", **{"from": "A", "to": "B"}).decode()
    assert plain != shown
    refused = server.client.get(f"{session}/map.svg?{asked}corridor")
    assert (refused.status_code, refused.json()["code"]) == (409, "no_route")


def test_a_png_has_the_size_asked_for_and_shows_the_map(server: Server, session: str) -> None:
    answer = server.client.get(f"{session}/map.png", params={"width": 800, "height": 400})
    assert answer.headers["Content-Type"] == "image/png"
    picture = image(answer.content)
    assert picture.size == (800, 400)
    assert len(np.unique(np.asarray(picture.convert("L")))) > 50
    unlabelled = ",".join(ALL_LAYERS - {Layer.LABELS, Layer.FRONTIERS})
    other = image(server.get(f"{session}/map.png", width=800, height=400, layers=unlabelled))
    inked = [np.asarray(each.convert("L")) < 80 for each in (picture, other)]
    assert inked[0].sum() - inked[1].sum() > 150, "names are drawn"


def test_a_picture_that_is_known_is_not_sent_again(server: Server, session: str) -> None:
    for form in ("svg", "png"):
        url = f"{session}/map.{form}?width=300"
        tag = server.client.get(url).headers["ETag"]
        known = server.client.get(url, headers={"If-None-Match": tag})
        assert (known.status_code, known.content) == (304, b"")
        assert server.get(url) == server.get(url)


def test_a_long_trail_is_thinned_the_same_way(new_database: Callable[[], str]) -> None:
    walk = [(0.1 * step, 1e-5 / (step + 1)) for step in range(2_101)]
    database = open_database(new_database())
    with database.writer.begin() as connection:
        store.add_session(connection, new_session("s", SessionRequest()))
        for seq, (x, y) in enumerate(walk, start=1):
            asked = step_request(StepDocument.model_validate(at(x, y)))
            logged = LoggedStep(seq, "", None, b"", asked.input, "{}")
            store.add_step(connection, 1, logged)
    with database.reader.begin() as connection:
        for seq in (1, 999, 1_000, 1_001, 2_101):
            found = store.list_positions(connection, 1, seq, trail_stride(seq))
            assert found == thinned_trail(walk[:seq])
    database.close()


def test_painting_keeps_nobody_waiting(server: Server) -> None:
    floor = Floor()
    path = server.create(world=world_json(floor.world), sensor={"range": 4.0, "samples": 40})
    for x, y in floor.path(6.0):
        server.step(path, at(x, y))
    server.get(f"{path}/map.svg", width=4096, height=4096)  # else it would be drawn first
    painted: list[int] = []

    def paint() -> None:
        url = f"{server.client.base_url}{path}/map.png?width=4096&height=4096"
        painted.append(httpx2.get(url, timeout=60).status_code)

    painting = threading.Thread(target=paint)
    painting.start()
    waits = []
    while painting.is_alive():
        begun = time.perf_counter()
        server.get("/healthz")
        waits.append(time.perf_counter() - begun)
        time.sleep(0.01)
    assert painted == [200]
    assert len(waits) > 20, "it was painted too fast to tell"
    assert float(np.quantile(waits, 0.9)) < 0.1


SVG = '<svg xmlns="http://www.w3.org/2000/svg" width="20" height="10"><text>x</text></svg>'


def test_a_painter_is_ended_when_it_takes_too_long() -> None:
    assert image(asyncio.run(Painter().png_of(SVG))).size == (20, 10)
    begun = time.monotonic()
    with pytest.raises(PictureError):
        asyncio.run(Painter(seconds_max=0.001).png_of(SVG))
    assert time.monotonic() - begun < 5


def test_what_is_no_picture_is_refused() -> None:
    with pytest.raises(PictureError):
        asyncio.run(Painter().png_of("<svg"))


def test_only_some_may_wait(monkeypatch: pytest.MonkeyPatch) -> None:
    async def crowd() -> list[object]:
        painter = Painter()
        asked = [painter.png_of(SVG) for _ in range(PAINTERS + WAITING_MAX + 3)]
        return list(await asyncio.gather(*asked, return_exceptions=True))

    monkeypatch.setattr(painters, "_COMMAND", ("sleep", "0.05"))
    outcomes = asyncio.run(crowd())
    assert [type(it) for it in outcomes].count(BusyError) == 3
    assert isinstance(outcomes[0], bytes)


@pytest.mark.parametrize("words", ["corridor", "Küche", "Кухня", "Κουζίνα"])
def test_every_sign_of_our_scripts_is_painted(words: str) -> None:
    """A script without signs in the font would leave the picture blank."""
    start = (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="200" height="40" font-family="{FONTS}">'
    )
    pictures = [
        np.asarray(image(png_of(f'{start}<text x="5" y="30" font-size="25">{it}</text></svg>')))
        for it in (words, words[:-1])
    ]
    painted = [int((each[..., 3] > 100).sum()) for each in pictures]
    assert painted[0] > painted[1] + 15

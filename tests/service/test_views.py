"""What can be seen of a map over HTTP is what the library draws and writes, to the byte."""

from __future__ import annotations

import json
from collections.abc import Callable

import pytest

from semtopo.exports import EXPORTS, Format
from semtopo.exports.chart import Chart
from semtopo.exports.geojson import border_features, borders_body, doorways_body
from semtopo.geometry import Box
from semtopo.mapper import MapState
from tests.servers import Server
from tests.service.twin import Twin, paper_steps, paper_world

pytestmark = pytest.mark.databases("sqlite", "postgres")


def exported(form: Format, radius: float = 0.0) -> Callable[[MapState], bytes]:
    return lambda state: EXPORTS[form].write(Chart(state, border_features(state), radius))


VIEWS: dict[str, Callable[[MapState], bytes]] = {
    "borders": borders_body,
    "doorways": doorways_body,
    **{f"export/{form}": exported(form) for form in Format},
}

every_view = pytest.mark.parametrize("view", VIEWS)


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


@every_view
@pytest.mark.parametrize("seq", [None, 0, 1, 29, 65, 81])
def test_a_view_is_that_of_the_library(
    server: Server, session: str, twin: Twin, view: str, seq: int | None
) -> None:
    query = {} if seq is None else {"at": seq}
    if view == "export/nav2" and seq in {0, 1}:  # there is nowhere to go yet
        refusal = server.client.get(f"{session}/{view}", params=query).json()
        assert refusal["code"] == "not_exportable"
        return
    shown = server.get(f"{session}/{view}", **query)
    assert shown == VIEWS[view](twin.states[twin.seq if seq is None else seq])
    assert server.get(f"{session}/{view}", **query) == shown


@pytest.mark.parametrize("seq", [66, 81])
@pytest.mark.parametrize(("view", "body"), [("borders", borders_body), ("doorways", doorways_body)])
def test_a_view_may_be_of_a_part(
    server: Server,
    session: str,
    twin: Twin,
    view: str,
    body: Callable[[MapState, Box | None, float], bytes],
    seq: int,
) -> None:
    corner = server.get(f"{session}/{view}", bbox="8,4.2,11,8", at=seq)
    assert corner == body(twin.states[seq], (8.0, 4.2, 11.0, 8.0), 0.0)
    assert 0 < corner.count(b"Feature") < server.get(f"{session}/{view}", at=seq).count(b"Feature")
    coarse = server.get(f"{session}/{view}", tolerance=0.2, at=seq)
    assert coarse == body(twin.states[seq], None, 0.2)
    assert len(coarse) < len(server.get(f"{session}/{view}", at=seq))
    nowhere = json.loads(server.get(f"{session}/{view}", bbox="-9,-9,-8.5,-8", at=seq))
    assert nowhere["features"] == []


@every_view
def test_a_view_that_is_known_is_not_sent_again(server: Server, session: str, view: str) -> None:
    url = f"{session}/{view}"
    tag = server.client.get(url).headers["ETag"]
    assert tag == server.client.get(f"{session}/zones").headers["ETag"]
    known = server.client.get(url, headers={"If-None-Match": tag})
    assert (known.status_code, known.content, known.headers["ETag"]) == (304, b"", tag)
    assert server.client.get(f"{url}?at=80", headers={"If-None-Match": tag}).status_code == 200


def test_the_radius_of_a_robot_counts(server: Server, session: str, twin: Twin) -> None:
    shown = server.get(f"{session}/export/nav2", radius=0.25)
    assert shown == exported(Format.NAV2, 0.25)(twin.states[-1])
    assert shown != server.get(f"{session}/export/nav2")


@pytest.mark.parametrize("form", Format)
def test_exports_have_the_media_type_of_their_format(
    server: Server, session: str, form: Format
) -> None:
    kind = server.client.get(f"{session}/export/{form}").headers["Content-Type"]
    assert kind.split(";")[0] == EXPORTS[form].media_type

"""What docs/routes.md shows is what a server answers to the paper's drive."""

from __future__ import annotations

import json
import re
import shlex
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import httpx2
import pytest

from service.schemas.answers import RouteQuery
from tests.servers import Json, Server
from tests.service.twin import paper_session, paper_steps, paper_world

PAGE = (Path(__file__).parents[2] / "docs" / "routes.md").read_text(encoding="utf-8")
ROWS = [[cell.strip() for cell in line.strip("|").split(" | ")] for line in PAGE.splitlines()]
FOUND = [row for row in ROWS if len(row) == 4 and "=" in row[0]]
REFUSED = [row for row in ROWS if len(row) == 3 and "=" in row[0]]
PARAMETERS = {name for row in ROWS if len(row) == 2 for name in re.findall(r"`(\w+)[`=]", row[0])}
COMMANDS = [
    shlex.split(command.replace("\\\n", " "))
    for block in re.findall(r"(?:^    .*\n)+", PAGE, re.MULTILINE)
    for command in re.findall(r"curl(?:.*\\\n)*.*", block)
]


@pytest.fixture(scope="module")
def driven(lasting_server: Server) -> str:
    """Give a session after the paper's 81 steps."""
    return paper_session(lasting_server)


def asked(server: Server, path: str, query: str) -> httpx2.Response:
    return server.client.get(f"{path}/route?{query.strip('`')}")


@pytest.mark.parametrize("row", FOUND, ids=lambda row: row[0])
def test_what_is_found(server: Server, driven: str, row: list[str]) -> None:
    query, zones, length, cost = row
    answer = asked(server, driven, query)
    assert answer.status_code == 200, answer.text
    route = answer.json()
    assert route["zones"] == zones.split(", ")
    assert route["length"] == pytest.approx(float(length), abs=0.06)
    assert route["cost"] == pytest.approx(float(cost), abs=0.06)
    assert ("path" in route) == ("radius" in query)
    assert ("alternatives" in route) == ("alternatives" in query)
    backwards = [passage.get("backwards", False) for passage in route["passages"]]
    assert any(backwards) == ("two_way" in query)


@pytest.mark.parametrize("row", REFUSED, ids=lambda row: row[0])
def test_what_is_refused(server: Server, driven: str, row: list[str]) -> None:
    query, code, told = (cell.strip("`") for cell in row)
    answer = asked(server, driven, query)
    assert answer.headers["Content-Type"] == "application/problem+json"
    problem = answer.json()
    assert problem["code"] == code
    for name, expected in json.loads(told).items():
        assert problem[name] == near(expected), name


def near(expected: object) -> object:
    """Return what compares numbers as exactly as the page shows them."""
    if isinstance(expected, list) and isinstance(expected[0], float):
        return pytest.approx(expected, abs=0.06)
    return pytest.approx(expected, abs=0.006) if isinstance(expected, float) else expected


def test_the_page_shows_every_parameter() -> None:
    fields = RouteQuery.model_fields.items()
    assert {field.alias or name for name, field in fields} == PARAMETERS
    used = {name for row in FOUND for name in re.findall(r"(\w+)=", row[0])}
    assert used == PARAMETERS
    assert len(REFUSED) >= 7


def test_routes_of_the_page_are_those_of_its_words(server: Server, driven: str) -> None:
    """As the page says: sentences ask the same."""
    text = {"text": "path from corridor to B via A avoiding D"}
    told = server.client.post(f"{driven}/query", json=text).json()["route"]
    (query,) = (row[0] for row in FOUND if "via" in row[0])
    route = asked(server, driven, query).json()
    assert told["zones"] == route["zones"]
    assert told["length"] == pytest.approx(route["length"])


def run(server: Server, path: str, command: list[str], restriction: str = "") -> httpx2.Response:
    """Send what a curl of the page would."""
    method, body, urls = "GET", None, []
    words = iter(command[1:])
    for word in words:
        if word == "-X":
            method = next(words)
        elif word == "--json":
            body = json.loads(next(words))
            method = "POST" if method == "GET" else method
        else:
            urls.append(word.replace("$restriction", restriction))
    (url,) = urls
    assert url.startswith("$url/$id/")
    rest = urlsplit(url.removeprefix("$url/$id")).path
    return server.client.request(method, f"{path}{rest}", json=body)


def command_of(*words: str) -> list[str]:
    (found,) = (it for it in COMMANDS if all(any(word in part for part in it) for word in words))
    return found


@pytest.fixture
def path(server: Server) -> str:
    """Give a session of one's own, after as many steps as show passages to A and back."""
    path = server.create(world=paper_world())
    for document in paper_steps()[:8]:
        server.step(path, document)
    return path


def test_names_are_set_as_shown(server: Server, path: str) -> None:
    answer = run(server, path, command_of("PUT"))
    assert answer.status_code == 200, answer.text
    (shown,) = (it for it in nodes(server, path) if it["id"] == "A")
    assert shown["aliases"] == ["the lab", "R 1/2"]
    assert shown["class"] == "office"
    for name in ("the lab", "R 1/2", "office"):
        route = server.client.get(f"{path}/route", params={"from": "corridor", "to": name}).json()
        assert route["target"] == "A"
    taken = server.client.put(f"{path}/zones/corridor", json={"aliases": ["the lab"]})
    assert taken.json()["code"] == "name_taken"


def nodes(server: Server, path: str) -> list[dict[str, Any]]:
    graph: Json = json.loads(server.get(f"{path}/graph"))
    listed: list[dict[str, Any]] = graph["nodes"]
    return listed


def test_passages_are_closed_and_opened_as_shown(server: Server, path: str) -> None:
    def closed() -> bool:
        answer = asked(server, path, "from=corridor&to=A")
        return answer.status_code == 409 and answer.json()["restricted"]

    assert not closed()
    made = run(server, path, command_of("expires_in"))
    assert made.status_code == 201, made.text
    restriction = made.json()["id"]
    assert closed()
    listing = next(it for it in COMMANDS if it == ["curl", "$url/$id/restrictions"])
    assert [it["id"] for it in run(server, path, listing).json()["restrictions"]] == [restriction]
    again = run(server, path, command_of("expires_in")).json()
    assert again["id"] == restriction, "it may safely be sent again"
    lifted = run(server, path, command_of("DELETE"), restriction)
    assert lifted.status_code == 204
    assert not closed()
    assert run(server, path, listing).json()["restrictions"] == []


def test_all_commands_of_the_page_are_run() -> None:
    assert len(COMMANDS) == 4

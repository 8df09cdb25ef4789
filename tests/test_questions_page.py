"""What docs/questions.md shows is what the example answers; digits may differ by machine."""

from __future__ import annotations

import re
import subprocess
import sys
from collections.abc import Callable
from functools import cache, partial
from pathlib import Path
from typing import get_args

import pytest

from semtopo.answers import Answer
from semtopo.errors import SemtopoError
from semtopo.questions import AVOIDED_MAX, STOPS_MAX, Named, PathQuestion
from semtopo.reading import parse
from tests.servers import Server
from tests.service.twin import paper_session
from tests.test_answers import ask

ROOT = Path(__file__).parents[1]
PAGE = (ROOT / "docs" / "questions.md").read_text(encoding="utf-8")
ROWS = [[cell.strip() for cell in line.split(" | ")] for line in PAGE.splitlines() if "|" in line]
ANSWERED = [(row[0].strip("| `"), row[1], row[2].strip("| ")) for row in ROWS if len(row) == 3][1:]
REFUSED = [
    (row[0].strip("| `"), re.findall(r"`(\w+)`", row[1]), row[2], row[3].strip("| "))
    for row in ROWS
    if len(row) == 4 and "`" in row[0]
]


def masked(text: str) -> str:
    return re.sub(r"\d+\.\d+|\d+", "#", text)


@pytest.mark.parametrize(("kind", "text", "sentence"), ANSWERED)
def test_what_is_answered(kind: str, text: str, sentence: str) -> None:
    found = ask(81, text)
    assert kind in {"", found.kind}
    assert masked(found.sentence) == masked(sentence)


@pytest.mark.parametrize(("code", "members", "text", "detail"), REFUSED)
def test_what_is_refused(code: str, members: list[str], text: str, detail: str) -> None:
    with pytest.raises(SemtopoError) as refused:
        ask(29 if code == "no_route" else 81, text)
    assert refused.value.code == code
    assert sorted(refused.value.facts) == sorted(members)
    assert masked(str(refused.value)) == masked(detail)


def test_every_kind_is_shown() -> None:
    kinds = [kind for kind, *_ in ANSWERED if kind]
    assert kinds == [answer.kind for answer in get_args(Answer)]
    assert len(REFUSED) == 4


@pytest.fixture(scope="module")
def after(lasting_server: Server) -> Callable[[int], str]:
    """Give sessions of the paper's drive after some steps, each driven once."""
    return cache(partial(paper_session, lasting_server))


@pytest.mark.parametrize(("kind", "text", "sentence"), ANSWERED)
def test_a_server_answers_the_same(
    server: Server, after: Callable[[int], str], kind: str, text: str, sentence: str
) -> None:
    answer = server.client.post(f"{after(81)}/query", json={"text": text}).json()
    assert kind in {"", answer["kind"]}
    assert masked(answer["sentence"]) == masked(sentence)


@pytest.mark.parametrize(("code", "members", "text", "detail"), REFUSED)
def test_a_server_refuses_the_same(
    server: Server,
    after: Callable[[int], str],
    code: str,
    members: list[str],
    text: str,
    detail: str,
) -> None:
    path = after(29 if code == "no_route" else 81)
    problem = server.client.post(f"{path}/query", json={"text": text}).json()
    assert problem["code"] == code
    assert masked(problem["detail"]) == masked(detail)
    assert set(members) <= problem.keys()


def test_a_robot_has_a_radius_and_may_go_both_ways(
    server: Server, after: Callable[[int], str]
) -> None:
    def answered(path: str, **options: object) -> dict[str, object]:
        text = {"text": "path from corridor to C", **options}
        found: dict[str, object] = server.client.post(f"{path}/query", json=text).json()
        return found

    assert "The path for the robot is" in str(answered(after(81), radius=0.2)["sentence"])
    assert answered(after(81), radius=0.9)["code"] == "too_narrow"
    assert answered(after(29))["code"] == "no_route"
    both = answered(after(29), two_way=True)
    assert "against the direction in which it is known" in str(both["sentence"])


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Give what `semtopo map` writes of the example."""
    out = tmp_path_factory.mktemp("map")
    example = ROOT / "examples" / "paper"
    files = (example / "world.json", example / "path.csv")
    command = [str(it) for it in (SEMTOPO, "map", *files, "--out", out)]
    subprocess.run(command, check=True, capture_output=True)
    return out


SEMTOPO = Path(sys.executable).with_name("semtopo")


@pytest.mark.parametrize("option", [(), ("--radius", "0.2"), ("--two-way",)], ids=" ".join)
def test_the_command_answers_the_same(folder: Path, option: tuple[str, ...]) -> None:
    (text, sentence) = next(row[1:] for row in ANSWERED if row[0] == "path")
    command = [str(SEMTOPO), "route", str(folder), text, *option]
    told = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    robot = " The path for the robot is # m long." if "--radius" in option else ""
    if "--two-way" not in option:  # both ways there is a shorter one
        assert masked(told.strip()) == masked(sentence) + robot
    assert told.startswith("Leave corridor at")


def words(sentence_with: str) -> list[str]:
    """Return what stands in backticks in a part of the page."""
    (part,) = re.findall(sentence_with, PAGE, re.DOTALL)
    return re.findall(r"`([^`]+)`", part)


def test_a_way_has_the_words_shown() -> None:
    nouns, verbs = words(r"A way is a (.*?); one may"), words(r"one may also (.*?)\. It leads")
    assert (len(nouns), len(verbs)) == (4, 5)
    first = parse("path from X to Y")
    for word in (*nouns, *verbs):
        assert same(parse(f"{word} from X to Y"), first), word


def same(one: object, other: object) -> bool:
    """Say whether two questions ask the same, wherever their names stand."""
    return re.sub(r"position=\d+", "", repr(one)) == re.sub(r"position=\d+", "", repr(other))


def test_a_way_leads_as_shown() -> None:
    forms = words(r"It leads\s+(.*?) from here")
    assert forms == ["from X to Y", "to Y from X", "between X and Y", "to Y"]
    for form in forms[:3]:
        assert same(parse(f"path {form}"), parse("path from X to Y")), form
    assert same(parse("path to Y"), parse("path from here to Y"))


def test_as_many_stops_as_shown_may_be_named() -> None:
    (stops, avoided) = re.findall(
        r"up to (\d+) zones to go to or\s+through, and up to (\d+)", PAGE
    )[0]
    assert (int(stops), int(avoided)) == (STOPS_MAX, AVOIDED_MAX)

    def via(count: int) -> str:
        return "path to Z via " + ", ".join(f"v{number}" for number in range(count))

    assert isinstance(parse(via(STOPS_MAX - 1)), PathQuestion)
    with pytest.raises(SemtopoError, match="at most 8"):
        parse(via(STOPS_MAX))


def test_the_quoted_names_shown_are_read() -> None:
    (example,) = [it for it in words(r"(Names with words.*?doubled\.)") if it.startswith("path")]
    question = parse(example)
    assert isinstance(question, PathQuestion)
    assert isinstance(question.start, Named)
    (leg,) = question.legs
    assert isinstance(leg.goal, Named)
    assert (question.start.name, leg.goal.name) == ("way to go", 'the "B"')


@pytest.mark.parametrize(
    "text",
    [
        "PATH FROM corridor TO C!",
        "path from corridor to C, please?",
        "path from the corridor to the C.",
    ],
)
def test_what_does_not_matter_does_not(text: str) -> None:
    assert ask(81, text) == ask(81, "path from corridor to C")


def test_a_question_is_as_long_as_shown_at_most(
    server: Server, after: Callable[[int], str]
) -> None:
    (most,) = re.findall(r"at most ([\d,]+) characters", PAGE)
    length = int(most.replace(",", ""))
    codes = [
        server.client.post(f"{after(81)}/query", json={"text": "where is ".ljust(it, "C")}).json()
        for it in (length, length + 1)
    ]
    assert [it["code"] for it in codes] == ["unknown_zone", "invalid_question"]

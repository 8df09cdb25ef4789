"""What docs/questions.md shows is what the example answers; digits may differ by machine."""

from __future__ import annotations

import re
from pathlib import Path
from typing import get_args

import pytest

from semtopo.answers import Answer
from semtopo.errors import SemtopoError
from tests.test_answers import ask

PAGE = (Path(__file__).parents[1] / "docs" / "questions.md").read_text(encoding="utf-8")
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

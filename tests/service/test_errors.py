"""Every error has a status and a code of its own, and the library's know nothing of HTTP."""

from __future__ import annotations

import ast
import importlib
import pkgutil
import re
from collections.abc import Iterator
from http import HTTPStatus
from pathlib import Path
from types import ModuleType

import pytest

import semtopo
import service
from semtopo.errors import InvalidInputError, SemtopoError
from service import problems
from service.problems import STATUS, status_of


def modules(package: ModuleType) -> Iterator[ModuleType]:
    for found in pkgutil.walk_packages(package.__path__, f"{package.__name__}."):
        yield importlib.import_module(found.name)


def classes(base: type[SemtopoError] = SemtopoError) -> Iterator[type[SemtopoError]]:
    """Yield all errors, wherever in the two packages they are defined."""
    yield base
    for child in base.__subclasses__():
        yield from classes(child)


LOADED = [*modules(semtopo), *modules(service)]
ALL = list(dict.fromkeys(classes()))
LEAVES = [error for error in ALL if not error.__subclasses__()]


def test_there_are_errors_of_both_packages() -> None:
    assert {error.__module__ for error in ALL} == {
        "semtopo.errors", "semtopo.errors.ways", "service.errors",
    }  # fmt: skip
    assert len(LEAVES) > 20


@pytest.mark.parametrize("error", LEAVES, ids=lambda error: error.__name__)
def test_every_leaf_has_a_status(error: type[SemtopoError]) -> None:
    status = HTTPStatus(status_of(error))
    assert status >= HTTPStatus.BAD_REQUEST
    assert error.__name__.endswith("Error")
    assert error.__doc__


def test_codes_are_words_and_no_two_errors_share_one() -> None:
    codes = [error.code for error in ALL]
    assert len(set(codes)) == len(codes)
    assert all(re.fullmatch(r"[a-z]+(_[a-z]+)*", code) for code in codes)
    assert all("code" in vars(error) for error in ALL)
    plain = set(problems._PLAIN_CODES.values())
    assert not plain & set(codes)


def test_codes_that_the_shape_of_a_request_leads_to_are_those_of_errors() -> None:
    assert set(problems._DOCUMENT_CODES.values()) <= {error.code for error in ALL}


ONLY_IN_COMMANDS = {"invalid_database", "invalid_key_name", "invalid_path", "unknown_key"}


def codes_written_in_place() -> Iterator[str]:
    """Yield the codes that stand as words where a problem is made."""
    for module in modules(service):
        assert module.__file__ is not None
        for node in ast.walk(ast.parse(Path(module.__file__).read_text(encoding="utf-8"))):
            if isinstance(node, ast.Call) and ast.unparse(node.func) == "Problem":
                code = node.args[1]
                if isinstance(code, ast.Constant):
                    yield str(code.value)


def test_the_table_of_codes_is_complete() -> None:
    page = (Path(__file__).parents[2] / "docs" / "errors.md").read_text(encoding="utf-8")
    table = dict(re.findall(r"^\| `(\w+)` \| (\w*) *\| .+ \|$", page, re.MULTILINE))
    plain = {code: str(status) for status, code in problems._PLAIN_CODES.items()}
    written = set(codes_written_in_place())
    assert {"malformed_json", "internal_error", "body_too_large"} <= written
    assert set(table) == {error.code for error in ALL} | set(plain) | written | {"refused"}
    assert list(table) == sorted(table)
    assert plain.items() <= table.items()
    for error in set(ALL) - {SemtopoError}:
        status = "" if error.code in ONLY_IN_COMMANDS else str(status_of(error))
        assert table[error.code] == status


def test_bad_input_is_the_callers_fault() -> None:
    ours = {"InvalidMapError", "InvalidDatabaseError"}  # stored here, or set by whoever runs it
    for error in LEAVES:
        if issubclass(error, InvalidInputError):
            assert issubclass(error, ValueError)
            assert status_of(error) == (500 if error.__name__ in ours else 422)


def test_the_nearest_base_says_the_status() -> None:
    class StrangeError(semtopo.NoRouteError):
        code = "strange"

    try:
        assert status_of(StrangeError) == STATUS[semtopo.NoRouteError]
    finally:
        del StrangeError


@pytest.mark.parametrize("module", list(modules(semtopo)), ids=lambda module: module.__name__)
def test_the_library_does_not_speak_of_http(module: ModuleType) -> None:
    assert module.__file__ is not None
    with open(module.__file__, encoding="utf-8") as source:  # noqa: PTH123 -- a module has a name
        tree = ast.parse(source.read())
    words = {node.id for node in ast.walk(tree) if isinstance(node, ast.Name)}
    words |= {node.attr for node in ast.walk(tree) if isinstance(node, ast.Attribute)}
    assert not any(re.search(r"http|status|response", word, re.IGNORECASE) for word in words)

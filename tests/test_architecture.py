"""The plan of the house: who may know whom, what is pure, and how large things are."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from graphlib import TopologicalSorter
from pathlib import Path
from statistics import median

import pytest

import semtopo

ROOT = Path(__file__).parents[1]

LAYERS = [
    {"errors"}, {"types"}, {"geometry", "window"},
    {"border", "ellipse", "fan", "inset", "triangulation", "world"}, {"traced"}, {"taut"},
    {"bottleneck"}, {"freespace"}, {"sensor"}, {"scan"}, {"runs", "sector", "strips"},
    {"course", "crossings"},
    {"doorways", "sweep"}, {"seams"}, {"fusion"}, {"zones"}, {"sensor_map"}, {"core"},
    {"metric"}, {"placement"},
    {"borders", "graph"}, {"findings"}, {"mapper"},
    {"notes"}, {"following"}, {"atlas", "expectations", "grammar", "likeness", "questions"},
    {"errand", "ground"}, {"network"}, {"search"}, {"gap", "journey"}, {"dense", "finder"},
    {"names", "phrases", "reading", "route"},
    {"answers"},
    {"codec", "documents", "readback", "wkb"},
    {"exports", "formats", "render"}, {"semtopo"},
]  # fmt: skip
"""The rooms of the library, from the ground up: each may know those below it."""

PURE = {
    "__future__", "collections", "colorsys", "contextlib", "csv", "dataclasses", "enum",
    "functools", "gzip", "heapq", "io", "itertools", "math", "re", "types", "typing",
    "unicodedata", "weakref", "xml.sax.saxutils", "zlib",
    "lark", "networkx", "numpy", "orjson", "pydantic", "shapely",
}  # fmt: skip
"""What the library may import: nothing that reads files, clocks, chance or the network."""

IMPURE_NAMES = {"breakpoint", "eval", "exec", "input", "open", "print", "random", "seed"}

SPEAK_SQL = {"database", "keys", "statements", "store", "tables", "transactions", "writer"}
HAND_ON = {"history", "hot", "key_desk", "past", "recording", "sessions"}
"""They name the type `Connection`, and hand what they get to those who speak SQL."""

NAME_DATABASE_ERRORS = {"problems"}

MODULE_LINES_MAX = 250  # blank ones not counted
FUNCTION_LINES_MAX = 40
MEDIAN_STATEMENTS_MAX = 8

SOURCES = {
    ".".join(path.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__"): path
    for package in ("semtopo", "service")
    for path in sorted((ROOT / package).rglob("*.py"))
}
TREES = {name: ast.parse(path.read_text(encoding="utf-8")) for name, path in SOURCES.items()}

every_module = pytest.mark.parametrize("name", SOURCES)
library_module = pytest.mark.parametrize("name", [it for it in SOURCES if it.startswith("semtopo")])


def imports(name: str) -> Iterator[tuple[str, str]]:
    """Yield what a module imports, as module and name in it; also inside functions."""
    for node in ast.walk(TREES[name]):
        if isinstance(node, ast.Import):
            yield from ((alias.name, "") for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, "imports name the whole module"
            assert node.module is not None
            for alias in node.names:
                inner = f"{node.module}.{alias.name}"
                yield (inner, "") if inner in SOURCES else (node.module, alias.name)


def functions(tree: ast.Module) -> Iterator[ast.FunctionDef | ast.AsyncFunctionDef]:
    yield from (
        node for node in ast.walk(tree) if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef)
    )


def layer(name: str) -> int:
    """Return the number of the layer in which a module of the library lies."""
    room = name.split(".")[1] if "." in name else name
    found = [number for number, rooms in enumerate(LAYERS) if room in rooms]
    assert found, f"give {name} a layer"
    return found[0]


@library_module
def test_a_room_knows_only_rooms_below(name: str) -> None:
    mine = name.split(".")[:2]
    for other, _ in imports(name):
        if other.startswith("semtopo") and other.split(".")[:2] != mine:
            assert layer(other) < layer(name), f"{name} imports {other}"


@library_module
def test_the_library_is_pure(name: str) -> None:
    for other, _ in imports(name):
        top = other if other in PURE else other.split(".")[0]
        assert top in PURE | {"semtopo"}, f"{name} imports {other}"
    for node in ast.walk(TREES[name]):
        called = node.func if isinstance(node, ast.Call) else None
        assert not (isinstance(called, ast.Name) and called.id in IMPURE_NAMES), called
        assert not (isinstance(node, ast.Attribute) and node.attr in IMPURE_NAMES), node.attr


def test_there_is_no_cycle() -> None:
    known = {
        name: {other for other, _ in imports(name) if other in SOURCES and other != name}
        for name in SOURCES
    }
    list(TopologicalSorter(known).static_order())  # raises CycleError


@pytest.mark.parametrize("name", [it for it in SOURCES if it.startswith("service.")])
def test_only_some_rooms_speak_sql(name: str) -> None:
    room = name.split(".")[1]
    used = {pair for pair in imports(name) if pair[0].split(".")[0] in {"sqlalchemy", "alembic"}}
    if room in HAND_ON:
        assert used <= {("sqlalchemy", "Connection")}
    elif room in NAME_DATABASE_ERRORS:
        assert {module for module, _ in used} <= {"sqlalchemy.exc"}
    elif room not in SPEAK_SQL:
        assert not used


def test_the_command_line_maps_without_the_server() -> None:
    """`semtopo map` starts fast: what serves is imported by the functions that serve alone."""
    slow = {"fastapi", "sqlalchemy", "uvicorn", "alembic"}
    seen, waiting = set(), ["service.cli"]
    while waiting:
        name = waiting.pop()
        seen.add(name)
        later = {
            other
            for function in functions(TREES[name])
            for node in ast.walk(function) if isinstance(node, ast.ImportFrom)
            for other in (node.module, *(f"{node.module}.{it.name}" for it in node.names))
        } if name in {"service.cli", "service.console"} else set()  # fmt: skip
        names = {other for other, _ in imports(name)} - later
        assert not {other.split(".")[0] for other in names} & slow, name
        waiting += [other for other in names if other in SOURCES and other not in seen]


def test_the_face_of_the_library_is_sorted_and_complete() -> None:
    assert semtopo.__all__ == sorted(semtopo.__all__)
    assert set(semtopo.__all__) == {name for _, name in imports("semtopo")}
    rooms = [tree for name, tree in TREES.items() if name.startswith("semtopo.errors")]
    errors = {node.name for tree in rooms for node in tree.body if isinstance(node, ast.ClassDef)}
    assert errors <= set(semtopo.__all__)


@every_module
def test_modules_and_functions_are_short(name: str) -> None:
    lines = SOURCES[name].read_text(encoding="utf-8").splitlines()
    assert sum(bool(line.strip()) for line in lines) <= MODULE_LINES_MAX
    for function in functions(TREES[name]):
        assert function.end_lineno is not None
        length = function.end_lineno - function.lineno + 1
        assert length <= FUNCTION_LINES_MAX, f"{name}.{function.name}"


def test_most_functions_are_very_short() -> None:
    sizes = [
        sum(isinstance(node, ast.stmt) for node in ast.walk(function)) - 1
        for tree in TREES.values()
        for function in functions(tree)
    ]
    assert median(sizes) < MEDIAN_STATEMENTS_MAX


@every_module
def test_everything_public_says_what_it_is(name: str) -> None:
    tree = TREES[name]
    assert ast.get_docstring(tree)
    classes = [node for node in tree.body if isinstance(node, ast.ClassDef)]
    for node in [*tree.body, *(inner for one in classes for inner in one.body)]:
        if isinstance(node, ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef):
            assert node.name.startswith("_") or ast.get_docstring(node), node.name

"""The modules of the page: each can be read, is used, and takes nothing that is not there."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from playwright.sync_api import Browser

from tests.servers import Server
from tests.viewer.browser import opened_page
from tests.viewer.test_page import home

VIEWER = Path(__file__).parents[2] / "service" / "viewer"
TEXTS = {path.name: path.read_text(encoding="utf-8") for path in sorted(VIEWER.glob("*.js"))}
TESTS = "".join(path.read_text(encoding="utf-8") for path in Path(__file__).parent.glob("*.py"))

IMPORT = re.compile(r'^import (?:\* as (\w+)|\{([^}]*)\}) from "\./(\w+\.js)";$', re.MULTILINE)
EXPORT = re.compile(r"^export (?:async )?(?:function|class|const|let) (\w+)", re.MULTILINE)
TYPE = re.compile(r'import\("\./(\w+\.js)"\)\.(\w+)')
TYPEDEF = r"(?:@typedef \{{.*\}} {0}\b|^export class {0}\b|@typedef \{{object\}} {0}\b)"

each_module = pytest.mark.parametrize("name", TEXTS)


def code(name: str) -> str:
    """Return a module without its comments and imports."""
    text = re.sub(r"/\*\*?.*?\*/", "", TEXTS[name], flags=re.DOTALL)
    return IMPORT.sub("", re.sub(r"//[^\"\n]*$", "", text, flags=re.MULTILINE))


def imported(name: str) -> dict[str, set[str]]:
    """Return what a module takes from which others, by their names there; `*` is all."""
    taken: dict[str, set[str]] = {}
    for whole, names, other in IMPORT.findall(TEXTS[name]):
        parts = {"*"} if whole else {part.strip() for part in names.split(",")}
        taken.setdefault(other, set()).update(part for part in parts if part)
    return taken


def test_all_can_be_imported(browser: Browser, server: Server) -> None:
    with opened_page(browser, home(server)) as page:
        found: dict[str, list[str] | str] = page.evaluate(
            """async (names) => Object.fromEntries(await Promise.all(names.map(async (name) => {
                try {
                    return [name, Object.keys(await import(`/viewer/${name}`))];
                } catch (error) {
                    return [name, String(error)];
                }
            })))""",
            list(TEXTS),
        )
    assert len(found) > 25
    for name, exports in found.items():
        assert exports == sorted(EXPORT.findall(TEXTS[name])), name


def test_all_are_reached_from_the_first() -> None:
    reached, left = set(), ["main.js"]
    while left:
        name = left.pop()
        if name not in reached:
            reached.add(name)
            left += imported(name)
    assert reached == set(TEXTS)


@each_module
def test_imports_are_used(name: str) -> None:
    assert len(re.findall(r"^import ", TEXTS[name], re.MULTILINE)) == len(
        IMPORT.findall(TEXTS[name])
    )
    text = code(name)
    for whole, names, _ in IMPORT.findall(TEXTS[name]):
        for taken in [whole] if whole else [part.strip() for part in names.split(",")]:
            assert not taken or re.search(rf"\b{taken}\b", text), taken


@each_module
def test_exports_are_used(name: str) -> None:
    for export in EXPORT.findall(TEXTS[name]):
        users = [other for other in TEXTS if other != name and name in imported(other)]
        taken = any(
            export in imported(other)[name]
            or ("*" in imported(other)[name] and re.search(rf"\.{export}\b", code(other)))
            for other in users
        )
        assert taken or re.search(rf"\b{export}\b", TESTS), export


@each_module
def test_constants_and_functions_are_used(name: str) -> None:
    text = code(name)
    for own in re.findall(r"^(?:async )?(?:const|let|function|class) (\w+)", text, re.MULTILINE):
        assert len(re.findall(rf"\b{own}\b", text)) > 1, own


@each_module
def test_types_are_those_of_other_modules(name: str) -> None:
    for other, wanted in TYPE.findall(TEXTS[name]):
        assert re.search(TYPEDEF.format(wanted), TEXTS[other], re.MULTILINE), (other, wanted)

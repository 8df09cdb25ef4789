"""The set-up layer: locks, wheel, Makefile, and nothing in the tree that belongs to one machine."""

import re
import subprocess
import sys
import tomllib
import zipfile
from importlib.metadata import entry_points
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

ROOT = Path(__file__).parents[1]
PYPROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())
LOCKS = [
    "requirements.lock", "requirements-runtime.lock", "requirements-build.lock",
    "requirements-bench.lock",
]  # fmt: skip
PACKAGES = ("semtopo", "service", "migrations")

# A path of somebody's machine: a folder below one of these.
MACHINE_PATH = re.compile(rb"(?<![\w.])/(?:home|Users|root|work)/\w")


def read_lock(name: str) -> dict[str, list[Requirement]]:
    """Give the locked requirements by name; a name may be locked once per Python version."""
    locked: dict[str, list[Requirement]] = {}
    for line in (ROOT / name).read_text().splitlines():
        if re.match(r"\w", line):
            requirement = Requirement(line.removesuffix("\\"))
            locked.setdefault(canonicalize_name(requirement.name), []).append(requirement)
    return locked


def group(name: str) -> list[Requirement]:
    """Give a dependency group of pyproject.toml without the groups that it includes."""
    entries = PYPROJECT["dependency-groups"][name]
    return [Requirement(entry) for entry in entries if isinstance(entry, str)]


def runtime() -> list[Requirement]:
    return [Requirement(entry) for entry in PYPROJECT["project"]["dependencies"]]


def tracked_files() -> list[Path]:
    """Give the files that git tracks, or would after `git add`."""
    listing = subprocess.run(
        ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"],
        cwd=ROOT,
        capture_output=True,
        check=True,
        text=True,
    ).stdout
    paths = [ROOT / name for name in listing.split("\0") if name]
    return [path for path in paths if path.is_file()]


@pytest.mark.parametrize("name", LOCKS)
def test_lock_names_no_host_and_hashes_everything(name: str) -> None:
    text = (ROOT / name).read_text()
    assert "://" not in text
    entries = re.split(r"\n(?=\w)", text)
    assert [entry for entry in entries if "--hash=sha256:" not in entry] == []


@pytest.mark.parametrize(
    ("name", "wanted"),
    [
        ("requirements.lock", runtime() + group("dev") + group("build")),
        ("requirements-runtime.lock", runtime()),
        ("requirements-build.lock", group("build")),
        ("requirements-bench.lock", group("bench")),
    ],
    ids=LOCKS,
)
def test_lock_satisfies_pyproject(name: str, wanted: list[Requirement]) -> None:
    locked = read_lock(name)
    for requirement in wanted:
        pins = locked.get(canonicalize_name(requirement.name), [])
        versions = [next(iter(pin.specifier)).version for pin in pins]
        assert versions, f"{requirement.name} is not locked"
        assert all(requirement.specifier.contains(version) for version in versions), requirement


def test_smaller_locks_agree_with_the_full_one() -> None:
    full = read_lock("requirements.lock")
    for name in LOCKS[1:3]:
        for package, pins in read_lock(name).items():
            assert {str(pin.specifier) for pin in pins} <= {
                str(pin.specifier) for pin in full[package]
            }


def test_peers_of_benchmarks_are_no_dependency() -> None:
    """They stand beside what is installed, so that none of it is there twice."""
    assert read_lock("requirements-bench.lock").keys().isdisjoint(read_lock("requirements.lock"))


def test_runtime_lock_has_no_development_tool() -> None:
    assert read_lock("requirements-runtime.lock").keys().isdisjoint({"pytest", "mypy", "uv"})


@pytest.mark.parametrize(
    ("target", "command"),
    [
        ("run", "semtopo serve --host 127.0.0.1 --port 8000"),
        ("test", "pytest"),
        ("lint", "hadolint Dockerfile"),
        ("types", "mypy"),
        ("bench", "scripts/peers.sh"),
        ("lock", "requirements-runtime.lock"),
        ("clean", "rm -rf .venv"),
    ],
)
def test_make_target(target: str, command: str) -> None:
    plan = subprocess.run(
        ["make", "--dry-run", "--always-make", target],
        cwd=ROOT,
        capture_output=True,
        check=True,
        text=True,
    ).stdout
    assert command in plan
    assert target == "clean" or "scripts/setup.sh" in plan


def test_wheel_holds_every_file_of_the_packages(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-d", str(tmp_path)]
    subprocess.run(command, cwd=ROOT, check=True, capture_output=True)
    (wheel,) = tmp_path.glob("*.whl")
    names = set(zipfile.ZipFile(wheel).namelist())
    wanted = {path.relative_to(ROOT).as_posix() for path in tracked_files()}
    assert {name for name in wanted if name.startswith(PACKAGES)} <= names
    assert "semtopo/py.typed" in names
    metadata = f"semtopo-{PYPROJECT['project']['version']}.dist-info"
    assert {name.split("/")[0] for name in names} == {*PACKAGES, metadata}


def test_command_is_installed() -> None:
    (command,) = entry_points(group="console_scripts", name="semtopo")
    assert callable(command.load())


def test_no_file_names_a_folder_of_one_machine() -> None:
    guilty = [path.name for path in tracked_files() if MACHINE_PATH.search(path.read_bytes())]
    assert guilty == []

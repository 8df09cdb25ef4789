"""A real server process on a real database file, as a robot would meet it."""

from __future__ import annotations

import itertools
import os
import random
import socket
import subprocess
import sys
import time
from collections.abc import Iterator, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any, Literal

import httpx2

SEMTOPO = Path(sys.executable).with_name("semtopo")
START_SECONDS_MAX = 120.0

Json = dict[str, Any]
Backend = Literal["sqlite", "postgres"]


class Server:
    """`semtopo serve` in a process of its own, on a free port of the loopback.

    Its database is a file in `folder`, unless a URL is given. `settings` become SEMTOPO_...
    variables. The port stays the same over restarts.
    """

    def __init__(self, folder: Path, url: str | None = None, **settings: object) -> None:
        """Choose a port; nothing runs yet."""
        folder.mkdir(exist_ok=True)
        self.url = f"sqlite:///{folder / 'semtopo.db'}" if url is None else url
        self.log = folder / "server.log"
        self.port = free_port()
        self.client = httpx2.Client(base_url=f"http://127.0.0.1:{self.port}", timeout=30)
        self.launcher: list[str] = []  # what starts the command, if not we ourselves
        self._settings = {f"SEMTOPO_{key.upper()}": str(it) for key, it in settings.items()}
        self._process: subprocess.Popen[bytes] | None = None

    @property
    def database(self) -> Path:
        """The file of a database that is one."""
        return Path(self.url.removeprefix("sqlite:///"))

    @property
    def pid(self) -> int:
        """The number of the running process."""
        assert self._process is not None
        return self._process.pid

    def start(self) -> None:
        """Start, and wait until the server answers."""
        with self.log.open("ab") as log:
            self._process = subprocess.Popen(
                [
                    *self.launcher,
                    SEMTOPO,
                    "serve",
                    "--port",
                    str(self.port),
                    "--database",
                    self.url,
                ],
                stdout=log,
                stderr=log,
                env={**os.environ, **self._settings},
            )
        give_up = time.monotonic() + START_SECONDS_MAX
        while not self._answers():
            assert self._process.poll() is None, self.log.read_text()
            assert time.monotonic() < give_up, "the server does not answer"
            time.sleep(0.02)

    def kill(self) -> None:
        """End the process as a power switch would: kill -9."""
        assert self._process is not None
        self._process.kill()
        self._process.wait()
        self._process = None

    def stop(self) -> None:
        """Ask the process to end, as a service manager would, and wait until it did."""
        assert self._process is not None
        self._process.terminate()
        status = self._process.wait(timeout=30)
        self._process = None
        assert status == 0, self.log.read_text()

    def restart(self) -> None:
        """Kill -9, and start again on the same database and port."""
        self.kill()
        self.start()

    def close(self) -> None:
        """End what still runs."""
        self.client.close()
        if self._process is not None:
            self.stop()

    def faults(self) -> list[str]:
        """Return the last lines of all tracebacks in the log."""
        return [block[-2000:] for block in self.log.read_text().split("Traceback")[1:]]

    def _answers(self) -> bool:
        try:
            return self.client.get("/healthz").status_code == httpx2.codes.OK
        except httpx2.TransportError:
            return False

    # What a robot asks for; each fails unless the answer is a success.

    def create(self, **session: object) -> str:
        """Begin a session, and return its path."""
        answer = self.client.post("/sessions", json=session)
        assert answer.status_code == 201, answer.text
        return str(answer.headers["Location"])

    def step(self, path: str, document: Json, headers: Mapping[str, str] | None = None) -> Json:
        """Take a step, and return its answer."""
        answer = self.client.post(f"{path}/step", json=document, headers=headers)
        assert answer.status_code == 201, answer.text
        body: Json = answer.json()
        return body

    def get(self, path: str, **query: object) -> bytes:
        """Return a body."""
        answer = self.client.get(path, params={key: str(it) for key, it in query.items()})
        assert answer.status_code == 200, answer.text
        return answer.content


def free_port() -> int:
    """Return a port on which nobody listens, which no other call returns soon, in no process.

    Port 0 would not do: the system may give such a port twice, or to a client's connection, before
    the server listens on it. Those given here lie below the system's own.
    """
    for port in _PORTS:
        with socket.socket() as probe, suppress(OSError):
            probe.bind(("127.0.0.1", port))
            return port
    raise AssertionError  # an endless iterator


def _own_ports() -> Iterator[int]:
    worker = int(os.environ.get("PYTEST_XDIST_WORKER", "gw0").removeprefix("gw"))
    first = 12_000 + 2_000 * (worker % 10)
    begin = random.randrange(2_000)  # another run of the tests may be under way
    return (first + (begin + number) % 2_000 for number in itertools.count())


_PORTS = _own_ports()

"""A reader of server-sent events, as a client of the service would write one."""

from __future__ import annotations

import json
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any

import httpx2

from tests.servers import Server


@dataclass
class Told:
    """One event; `id` is what Last-Event-ID would name after it."""

    event: str
    id: str
    data: Any


@dataclass
class Reader:
    """Reads events from the lines of an answer; `id` is the last one, `comments` are heartbeats."""

    lines: Iterator[str]
    id: str = ""
    comments: int = 0
    _data: list[str] = field(default_factory=list)
    _event: str = ""

    def __iter__(self) -> Iterator[Told]:
        """Yield events until the server ends the answer."""
        for line in self.lines:
            name, _, value = line.partition(": ")
            if line.startswith(":"):
                self.comments += 1
            elif name == "data":
                self._data.append(value)
            elif name == "event":
                self._event = value
            elif name == "id":
                self.id = value
            elif not line:
                yield from self._flush()

    def next(self) -> Told:
        """Return the next event."""
        return next(iter(self))

    def take(self, count: int) -> list[Told]:
        """Return so many events."""
        return [self.next() for _ in range(count)]

    def _flush(self) -> Iterator[Told]:
        data, event = self._data, self._event
        self._data, self._event = [], ""
        if data:
            yield Told(event, self.id, json.loads("\n".join(data)))


@contextmanager
def following(
    server: Server, path: str, after: object = None, key: str | None = None
) -> Iterator[Reader]:
    """Follow a session, after a step or from now on; the id is known when this returns."""
    headers = {} if after is None else {"Last-Event-ID": str(after)}
    if key is not None:
        headers["Authorization"] = f"Bearer {key}"
    client = httpx2.Client(base_url=str(server.client.base_url), timeout=30)
    with client, client.stream("GET", f"{path}/events", headers=headers) as answer:
        assert answer.status_code == 200, answer.read()
        assert answer.headers["Content-Type"].startswith("text/event-stream")
        assert answer.headers["Cache-Control"] == "no-store"
        lines = answer.iter_lines()
        reader = Reader(lines)
        for line in lines:  # the head of the stream ends with an empty line
            if line.startswith("id: "):
                reader.id = line.removeprefix("id: ")
            if not line:
                break
        yield reader

"""Load a server on loopback: clients that post one request after the other, and time each."""

from __future__ import annotations

import asyncio
import time
from collections.abc import Callable
from dataclasses import dataclass

HOST = "127.0.0.1"


@dataclass(frozen=True, slots=True)
class Load:
    """How long requests took, in ms, sorted; and how long all of it took, in s."""

    times: list[float]
    seconds: float

    def percentile(self, share: float) -> float:
        """Return the time in ms within which this share of the requests was answered."""
        return self.times[min(len(self.times) - 1, int(share * len(self.times)))]

    @property
    def rate(self) -> float:
        """Requests a second."""
        return len(self.times) / self.seconds


def request_bytes(method: str, path: str, body: bytes = b"", **headers: str) -> bytes:
    """Return a request as it goes over the wire; further headers are named with underscores."""
    more = "".join(f"{name.replace('_', '-')}: {it}\r\n" for name, it in headers.items())
    head = (
        f"{method} {path} HTTP/1.1\r\nHost: {HOST}\r\n"
        f"Content-Type: application/json\r\nContent-Length: {len(body)}\r\n{more}\r\n"
    )
    return head.encode() + body


async def exchange(
    reader: asyncio.StreamReader, writer: asyncio.StreamWriter, request: bytes
) -> tuple[int, bytes]:
    """Send a request, and return the status and the body of its answer."""
    writer.write(request)
    head = (await reader.readuntil(b"\r\n\r\n")).lower()
    _, _, told = head.partition(b"content-length: ")
    length = int(told.split(b"\r\n")[0] or 0)  # 304 has none
    return int(head[9:12]), await reader.readexactly(length)


async def _client(
    port: int | Callable[[int], int],
    requests: Callable[[int], bytes],
    numbers: range,
    expected: int,
    taken_off: Callable[[bytes], float] | None,
) -> list[float]:
    streams: dict[int, tuple[asyncio.StreamReader, asyncio.StreamWriter]] = {}
    times = []
    for number in numbers:
        request = requests(number)
        to = port(number) if callable(port) else port
        if to not in streams:
            streams[to] = await asyncio.open_connection(HOST, to)
        reader, writer = streams[to]
        begun = time.perf_counter()
        status, body = await exchange(reader, writer, request)
        took = 1000 * (time.perf_counter() - begun)
        times.append(took - taken_off(body) if taken_off else took)
        if status != expected:
            raise RuntimeError(f"unexpected answer {status}: {body[:200]!r}")
    for _, writer in streams.values():
        writer.close()
    return times


def run(
    port: int | Callable[[int], int],
    requests: Callable[[int], bytes],
    *,
    clients: int,
    count: int,
    expected: int = 201,
    taken_off: Callable[[bytes], float] | None = None,
) -> Load:
    """Send `count` requests from several clients at once, each one after the other.

    Where there are several servers, `port` says from the number of a request which one gets it.
    `taken_off` says, from the body of an answer, how many ms are not to be counted.
    """

    async def all_clients() -> list[list[float]]:
        shares = [range(first, count, clients) for first in range(clients)]
        work = [_client(port, requests, share, expected, taken_off) for share in shares]
        return await asyncio.gather(*work)

    begun = time.perf_counter()
    groups = asyncio.run(all_clients())
    return Load(sorted(t for group in groups for t in group), time.perf_counter() - begun)

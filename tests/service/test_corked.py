"""An answer leaves in one piece where that is cheap, and never later than it would have."""

from __future__ import annotations

import asyncio
import socket
from collections.abc import Callable
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from service.corked import JOINED_BYTES_MAX, Corked
from tests.servers import Server


class Below(asyncio.Transport):
    """Takes note of what is done to it."""

    def __init__(self) -> None:
        super().__init__()
        self.done: list[Any] = []

    def write(self, data: Any) -> None:  # noqa: ANN401 -- as asyncio has it
        self.done.append(bytes(data))

    def close(self) -> None:
        self.done.append("closed")

    def abort(self) -> None:
        self.done.append("aborted")

    def is_closing(self) -> bool:
        return "closed" in self.done

    def pause_reading(self) -> None:
        self.done.append("paused")

    def resume_reading(self) -> None:
        self.done.append("resumed")

    def get_write_buffer_size(self) -> int:
        return 7

    def get_extra_info(self, name: str, default: Any = None) -> Any:  # noqa: ANN401 -- the same
        return {"peername": "there"}.get(name, default)

    def set_protocol(self, protocol: asyncio.BaseProtocol) -> None:
        self.done.append(protocol)


def done_to(act: Callable[[Corked], object], *, turns: int = 0) -> list[Any]:
    """Return what is done to the transport below, up to so many turns of the loop later."""

    async def run() -> list[Any]:
        below = Below()
        act(Corked(below))
        for _ in range(turns):
            await asyncio.sleep(0)
        return below.done

    return asyncio.run(run())


def test_two_writes_are_one() -> None:
    def act(corked: Corked) -> None:
        corked.write(b"head")
        corked.write(b"body")

    assert done_to(act) == [b"headbody"]
    assert done_to(act, turns=3) == [b"headbody"]


def test_one_write_leaves_in_the_next_turn() -> None:
    def act(corked: Corked) -> None:
        corked.write(b"event")
        assert corked.get_write_buffer_size() == len(b"event") + 7

    assert done_to(act, turns=1) == [b"event"]


def test_what_is_large_is_not_copied() -> None:
    large = b"x" * (JOINED_BYTES_MAX + 1)

    def act(corked: Corked) -> None:
        corked.write(b"head")
        corked.write(large)

    assert done_to(act) == [b"head", large]


def test_nothing_is_lost_when_the_connection_is_closed() -> None:
    def act(corked: Corked) -> None:
        corked.write(b"last")
        assert not corked.is_closing()
        corked.close()
        assert corked.is_closing()

    assert done_to(act, turns=2) == [b"last", "closed"]


def test_what_is_aborted_sends_nothing_more() -> None:
    def act(corked: Corked) -> None:
        corked.write(b"last")
        corked.abort()

    assert done_to(act, turns=2) == ["aborted"]


def test_another_protocol_gets_the_connection_with_all_sent() -> None:
    protocol = asyncio.Protocol()

    def act(corked: Corked) -> None:
        corked.write(b"switching")
        corked.set_protocol(protocol)

    assert done_to(act) == [b"switching", protocol]


def test_what_is_kept_counts_as_not_sent() -> None:
    def act(corked: Corked) -> None:
        assert corked.get_write_buffer_size() == 7
        corked.write(b"four")
        assert corked.get_write_buffer_size() == 11
        corked.pause_reading()
        corked.resume_reading()
        assert corked.get_extra_info("peername") == "there"
        assert corked.get_extra_info("sockname", 1) == 1

    assert done_to(act) == ["paused", "resumed", b"four"]


@given(st.lists(st.binary(max_size=8) | st.just(b"x" * (JOINED_BYTES_MAX + 1)), max_size=8))
def test_bytes_leave_in_order(writes: list[bytes]) -> None:
    def act(corked: Corked) -> None:
        for one in writes:
            corked.write(one)

    assert b"".join(done_to(act, turns=1)) == b"".join(writes)


@pytest.mark.parametrize("path", ["/healthz", "/openapi.json", "/nowhere"])
def test_answers_are_the_same_as_ever(server: Server, path: str) -> None:
    with socket.create_connection(("127.0.0.1", server.port), timeout=30) as connection:
        connection.sendall(f"GET {path} HTTP/1.1\r\nHost: x\r\nConnection: close\r\n\r\n".encode())
        got = b""
        while piece := connection.recv(2**20):
            got += piece
    _, _, body = got.partition(b"\r\n\r\n")
    assert body == server.client.get(path).content

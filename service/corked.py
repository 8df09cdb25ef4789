"""Send the head of an answer together with its body.

uvicorn writes them one after the other, which takes a call of the system each, some 40 µs, and a
packet each.
"""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from typing import Any

JOINED_BYTES_MAX = 2**16
"""More is not copied to save a call."""


class Corked(asyncio.Transport):
    """A transport that keeps a write back until the next one, or until the loop's next turn."""

    def __init__(self, below: asyncio.Transport) -> None:
        """Write to another transport."""
        super().__init__()
        self._below = below
        self._kept = b""
        self._turn: asyncio.Handle | None = None
        # uvicorn and our own protocol call these often
        self.is_closing: Callable[[], bool] = below.is_closing
        self.pause_reading: Callable[[], None] = below.pause_reading
        self.resume_reading: Callable[[], None] = below.resume_reading

    def write(self, data: Any) -> None:  # noqa: ANN401 -- as asyncio has it, anything like bytes
        """Keep what there is, or send it with what was kept."""
        if not self._kept:
            self._kept = data
            self._turn = asyncio.get_running_loop().call_soon(self.flush)
        elif len(data) > JOINED_BYTES_MAX:
            self.flush()
            self._below.write(data)
        else:
            self._kept += data
            self.flush()

    def flush(self) -> None:
        """Send what was kept."""
        if self._turn is not None:
            self._turn.cancel()
            self._turn = None
        if self._kept:
            kept, self._kept = self._kept, b""
            self._below.write(kept)

    def close(self) -> None:
        """Send what was kept, and close."""
        self.flush()
        self._below.close()

    def abort(self) -> None:
        """Close at once."""
        self._kept = b""
        self._below.abort()

    def get_write_buffer_size(self) -> int:
        """Return how many bytes have not left yet."""
        return len(self._kept) + self._below.get_write_buffer_size()

    def get_extra_info(self, name: str, default: Any = None) -> Any:  # noqa: ANN401 -- as asyncio has it
        """Tell about the connection."""
        return self._below.get_extra_info(name, default)

    def set_protocol(self, protocol: asyncio.BaseProtocol) -> None:
        """Hand the connection to another protocol."""
        self.flush()
        self._below.set_protocol(protocol)

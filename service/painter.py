"""Have pictures painted by processes of their own.

Painting holds the interpreter's lock for up to some seconds, during which no thread of this process
could do anything. A process can also be ended when it takes too long.
"""

from __future__ import annotations

import asyncio
import sys
from asyncio.subprocess import DEVNULL, PIPE

from service.errors import BusyError, PictureError

PAINTERS = 2
"""Processes at once."""

WAITING_MAX = 16
"""Pictures that may wait for one of them."""

SECONDS_MAX = 20.0
"""For one picture; the largest that may be asked for takes some 5 s on one slow processor."""

_COMMAND = (sys.executable, "-I", "-m", "service.painting")


class Painter:
    """Paints some pictures at once, and lets some more wait. For one event loop only."""

    def __init__(self, seconds_max: float = SECONDS_MAX) -> None:
        """Begin with nothing to paint."""
        self._free = asyncio.Semaphore(PAINTERS)
        self._pictures = 0
        self._seconds_max = seconds_max

    async def png_of(self, svg: str) -> bytes:
        """Return a picture as PNG.

        Raises
        ------
        BusyError
            Too many pictures wait already.
        PictureError
            It took too long, or could not be painted at all.
        """
        if self._pictures >= PAINTERS + WAITING_MAX:
            raise BusyError("too many pictures are waiting")
        self._pictures += 1
        try:
            async with self._free:
                return await self._painted(svg.encode())
        finally:
            self._pictures -= 1

    async def _painted(self, svg: bytes) -> bytes:
        process = await asyncio.create_subprocess_exec(
            *_COMMAND, stdin=PIPE, stdout=PIPE, stderr=DEVNULL
        )
        try:
            async with asyncio.timeout(self._seconds_max):
                png, _ = await process.communicate(svg)
        except TimeoutError:
            raise PictureError(
                "the picture takes too long to paint; ask for a smaller one"
            ) from None
        finally:
            if process.returncode is None:
                process.kill()
                await process.wait()
        if process.returncode != 0:
            raise PictureError("the picture could not be painted")
        return png

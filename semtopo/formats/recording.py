"""Recordings of labelled scans: JSON lines, plain or gzip, one `RecordedScan` a line."""

from __future__ import annotations

import gzip
import io
import zlib
from collections.abc import Iterator

from pydantic import ValidationError

from semtopo.documents import RecordedScan
from semtopo.errors import InvalidScanError
from semtopo.formats.fault import describe_fault
from semtopo.runs import LabelledRuns
from semtopo.types import Pose

LINE_BYTES_MAX = 2**24
"""Far above any scan; without a bound, a small gzip file could fill the memory."""

_GZIP_MAGIC = b"\x1f\x8b"


def read_recording(content: bytes) -> Iterator[tuple[Pose, LabelledRuns]]:
    """Yield each pose with what was seen from it; at least one. Blank lines are passed over.

    A line is read when it is asked for, so a fault in it comes to light then.

    Raises
    ------
    InvalidScanError
        A line is no scan (the error has its number), there is none, or the gzip data is damaged.
    """
    number = 0
    for number, line in _lines(content):
        yield _scan(number, line)
    if number == 0:
        raise InvalidScanError("the recording has no scan")


def count_scans(content: bytes) -> int:
    """Return how many scans a recording holds, without reading them.

    Raises
    ------
    InvalidScanError
        A line is too long, or the gzip data is damaged.
    """
    return sum(1 for _ in _lines(content))


def _lines(content: bytes) -> Iterator[tuple[int, bytes]]:
    """Yield the number and the bytes of each line that is not blank."""
    packed = io.BytesIO(content)
    plain = gzip.GzipFile(fileobj=packed) if content.startswith(_GZIP_MAGIC) else packed
    number = 0
    try:
        while line := plain.readline(LINE_BYTES_MAX + 1):
            number += 1
            if len(line) > LINE_BYTES_MAX:
                raise InvalidScanError(f"line {number}: longer than 16 MiB")
            if line.strip():
                yield number, line
    except (gzip.BadGzipFile, EOFError, zlib.error):
        raise InvalidScanError(f"after line {number}: the gzip data is damaged") from None


def _scan(number: int, line: bytes) -> tuple[Pose, LabelledRuns]:
    """Return the pose and the scan of one line."""
    try:
        recorded = RecordedScan.model_validate_json(line)
        return recorded.pose.value(), recorded.scan.value()
    except ValidationError as error:
        raise InvalidScanError(f"line {number}: {describe_fault(error)}") from None
    except InvalidScanError as error:
        raise InvalidScanError(f"line {number}: {error}") from None

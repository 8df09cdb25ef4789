"""Paths as CSV with the header `x,y` or `x,y,theta`: m and rad, map frame, one pose a line."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator

from pydantic import ValidationError

from semtopo.documents import PoseDocument
from semtopo.errors import InvalidPathError
from semtopo.formats.fault import describe_fault
from semtopo.types import Pose

HEADERS = (["x", "y"], ["x", "y", "theta"])


def read_path(content: bytes) -> list[Pose]:
    """Return the poses of a CSV file in order; at least one. Blank lines are passed over.

    Raises
    ------
    InvalidPathError
        The header is another, a line is no pose (the error has its number), or there is none.
    """
    try:
        lines = _lines(content.decode("utf-8-sig"))
    except (UnicodeDecodeError, csv.Error):
        raise InvalidPathError("the path is no CSV text") from None
    header = next(lines, (0, []))[1]
    if header not in HEADERS:
        raise InvalidPathError("the first line of a path must be x,y or x,y,theta")
    poses = [_pose(header, number, cells) for number, cells in lines]
    if not poses:
        raise InvalidPathError("the path has no pose")
    return poses


def _lines(text: str) -> Iterator[tuple[int, list[str]]]:
    """Return the number and the cells of each line that is not blank."""
    rows = csv.reader(io.StringIO(text, newline=""))
    cells = [(rows.line_num, [cell.strip() for cell in row]) for row in rows]
    return iter([(number, row) for number, row in cells if any(row)])


def _pose(header: list[str], number: int, cells: list[str]) -> Pose:
    """Return the pose of one line."""
    if len(cells) != len(header):
        raise InvalidPathError(f"line {number}: expected {len(header)} numbers")
    try:
        values = dict(zip(header, map(float, cells), strict=True))
        return PoseDocument.model_validate(values).value()
    except ValidationError as error:
        raise InvalidPathError(f"line {number}: {describe_fault(error)}") from None
    except ValueError:
        raise InvalidPathError(f"line {number}: expected numbers") from None

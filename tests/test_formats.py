"""Files that are what they should be are read; all others are refused in one line that says why."""

import gzip
import json
import math
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from semtopo.errors import InvalidInputError, InvalidPathError, InvalidScanError, InvalidWorldError
from semtopo.formats import count_scans, read_path, read_recording, read_world
from semtopo.formats.recording import LINE_BYTES_MAX
from semtopo.types import Kind, Pose

Json = dict[str, Any]


def world(**changes: object) -> bytes:
    zone = {"label": "hall", "kind": "space", "low": [0, 0], "high": [2, 1], **changes}
    return json.dumps({"zones": [zone]}).encode()


def scan_line(**changes: object) -> bytes:
    scan = {
        "angle_min": 0,
        "angle_increment": 0.5,
        "range_max": 4,
        "beams": [[["hall", 2.0], ["door", 2.5]], []],
        "kinds": {"door": "passage"},
        **changes,
    }
    return json.dumps({"k": 1, "pose": {"x": 1, "y": 2, "theta": 0.5}, "scan": scan}).encode()


class TestWorld:
    def test_valid(self) -> None:
        (zone,) = read_world(world()).zones
        assert (zone.label, zone.kind, zone.low, zone.high) == ("hall", Kind.SPACE, (0, 0), (2, 1))

    @pytest.mark.parametrize(
        ("content", "fault"),
        [
            (b"", "Invalid JSON: EOF"),
            (b"{", "Invalid JSON: EOF"),
            (b"\xff\xfe", "Invalid JSON"),
            (b"[]", "Input should be an object"),
            (b"{}", "zones: Field required"),
            (b'{"zones": []}', "zones: List should have at least 1 item"),
            (world(low=[0, 5]), "zones.0: low must be below high in x and in y"),
            (world(low=[math.nan, 0]), "zones.0.low.0: Input should be a finite number"),
            (world(high=[math.inf, 0]), "zones.0.high.0: Input should be a finite number"),
            (world(high=[1e7, 1]), "zones.0.high.0: Input should be less than or equal to"),
            (world(low=["0", 0]), "zones.0.low.0: Input should be a valid number"),
            (world(low=[0]), "zones.0.low.1: Field required"),
            (world(kind="lava"), "zones.0.kind: Input should be 'space'"),
            (world(label=""), "zones.0.label: String should have at least 1 character"),
            (world(label="a\nb"), "zones.0.label: a name holds only printable characters"),
            (world(colour=1), "zones.0.colour: Extra inputs are not permitted"),
        ],
    )
    def test_invalid(self, content: bytes, fault: str) -> None:
        with pytest.raises(InvalidWorldError) as raised:
            read_world(content)
        assert str(raised.value).startswith(fault)

    def test_does_not_repeat_what_came_in(self) -> None:
        with pytest.raises(InvalidWorldError) as raised:
            read_world(world(**{"x\n" * 10_000: 1}))
        assert len(str(raised.value)) < 200
        assert "\n" not in str(raised.value)


class TestPath:
    def test_with_heading(self) -> None:
        assert read_path(b"x,y,theta\n1,2,0.5\n-3.5,4e1,0\n") == [Pose(1, 2, 0.5), Pose(-3.5, 40)]

    @pytest.mark.parametrize(
        "content",
        [
            b"x,y\n1,2",
            b"x,y\r\n1,2\r\n",
            b"\xef\xbb\xbfx,y\n1,2\n",
            b"x, y\n 1 , 2 \n",
            b'"x","y"\n"1","2"\n',
            b"x,y\n1,2\n\n\n  \n",
        ],
        ids=["no last end", "crlf", "byte order mark", "spaces", "quotes", "blank lines"],
    )
    def test_without_heading(self, content: bytes) -> None:
        assert read_path(content) == [Pose(1, 2)]

    @pytest.mark.parametrize(
        ("content", "fault"),
        [
            (b"", "the first line of a path must be x,y or x,y,theta"),
            (b"1,2\n3,4\n", "the first line of a path must be"),
            (b"y,x\n3,4\n", "the first line of a path must be"),
            (b"x,y\n", "the path has no pose"),
            (b"x,y\n1,2\n3\n", "line 3: expected 2 numbers"),
            (b"x,y\n1,2,3\n", "line 2: expected 2 numbers"),
            (b"x,y\n\n1,b\n", "line 3: expected numbers"),
            (b"x,y\n1,\n", "line 2: expected numbers"),
            (b"x,y\nnan,2\n", "line 2: x: Input should be a finite number"),
            (b"x,y,theta\n1,2,inf\n", "line 2: theta: Input should be a finite number"),
            (b"x,y\n1,1e300\n", "line 2: y: Input should be less than or equal to"),
            (b"\xff\xfe\x00", "the path is no CSV text"),
            (b"x,y\n" + b"1" * 200_000 + b",2\n", "the path is no CSV text"),
        ],
    )
    def test_invalid(self, content: bytes, fault: str) -> None:
        with pytest.raises(InvalidPathError) as raised:
            read_path(content)
        assert str(raised.value).startswith(fault)


class TestRecording:
    @pytest.mark.parametrize("pack", [bytes, gzip.compress], ids=["plain", "gzip"])
    def test_valid(self, pack: Any) -> None:  # noqa: ANN401 -- bytes to bytes
        content = pack(scan_line() + b"\n\n" + scan_line(range_max=5) + b"\n\n")
        (pose, first), (_, second) = read_recording(content)
        assert pose == Pose(1, 2, 0.5)
        assert (first.range_max, second.range_max) == (4, 5)
        assert first.kinds == {"door": Kind.PASSAGE}
        assert count_scans(content) == 2

    @pytest.mark.parametrize(
        ("line", "fault"),
        [
            (b"{}", "pose: Field required"),
            (b"no", "Invalid JSON"),
            (scan_line(beams=[[["hall", 2.0], ["door", 1.0]]]), "beam 0: radii must ascend"),
            (scan_line(beams=[[["hall", 5.0]]]), "beam 0: a radius exceeds range_max"),
            (scan_line(beams=[[["hall", math.nan]]]), "scan.beams.0.0.1: Input should be"),
            (scan_line(range_max=0), "scan.range_max: Input should be greater than 0"),
            (scan_line(angle_increment=0), "angle_increment must not be 0"),
            (scan_line(kinds={"door": "lava"}), "scan.kinds.door: Input should be 'space'"),
        ],
    )
    def test_names_the_line(self, line: bytes, fault: str) -> None:
        scans = read_recording(scan_line() + b"\n" + line + b"\n")
        next(scans)
        with pytest.raises(InvalidScanError) as raised:
            next(scans)
        assert str(raised.value).startswith(f"line 2: {fault}")

    @pytest.mark.parametrize("content", [b"", b"\n \n", gzip.compress(b"", mtime=0)])
    def test_empty(self, content: bytes) -> None:
        with pytest.raises(InvalidScanError, match="the recording has no scan"):
            list(read_recording(content))

    @pytest.mark.parametrize("cut", [-1, -9, 30, 5])
    def test_cut_gzip(self, cut: int) -> None:
        content = gzip.compress(b"\n".join([scan_line()] * 50))[:cut]
        with pytest.raises(InvalidScanError, match="the gzip data is damaged"):
            list(read_recording(content))

    def test_changed_gzip(self) -> None:
        content = bytearray(gzip.compress(b"\n".join([scan_line()] * 50)))
        content[40] ^= 0xFF
        with pytest.raises(InvalidScanError):
            list(read_recording(bytes(content)))

    def test_a_small_file_cannot_fill_the_memory(self) -> None:
        content = gzip.compress(b" " * (3 * LINE_BYTES_MAX))
        with pytest.raises(InvalidScanError, match="line 1: longer than 16 MiB"):
            count_scans(content)


@given(st.binary(max_size=200) | st.text(max_size=200).map(str.encode))
def test_any_bytes_are_read_or_refused(content: bytes) -> None:
    for read in (read_world, read_path, lambda given: list(read_recording(given))):
        try:
            read(content)
        except InvalidInputError as error:
            assert len(str(error).splitlines()) == 1  # noqa: PT017 -- or it is read

"""Write what the robot saw as JSON: where the beams of one scan ended, and why."""

from __future__ import annotations

from semtopo.codec import to_json
from semtopo.scan import Scan
from semtopo.types import Occupancy, Pose


def sight_body(seq: int, seen: tuple[Pose, Scan] | None) -> bytes:
    """Return the ends of the beams of step `seq`; none before the first step."""
    if seen is None:
        return to_json({"seq": seq, "pose": None, "ends": [], "occupancy": []})
    pose, scan = seen
    ends, occupancy = scan.ends()
    return to_json(
        {
            "seq": seq,
            "pose": {"x": pose.x, "y": pose.y, "theta": pose.theta},
            "ends": ends,
            "occupancy": [Occupancy(number).name.lower() for number in occupancy.tolist()],
        }
    )

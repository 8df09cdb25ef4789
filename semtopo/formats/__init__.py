"""Read worlds, paths and recordings from the bytes of their files.

In come bytes; out come values, or an error that says in one line what is wrong and where. Opening
files is the business of whoever has them.
"""

from semtopo.formats.path import read_path
from semtopo.formats.recording import count_scans, read_recording
from semtopo.formats.world import read_world

__all__ = ["count_scans", "read_path", "read_recording", "read_world"]

"""Freed memory is for all threads."""

from __future__ import annotations

import subprocess
import sys

import pytest

ALLOCATE = """
import ctypes, threading
from service.memory import share_arena
{first}
held, both = [], threading.Barrier(4)
def work():
    both.wait()  # so that they are different threads at one time
    held.extend(bytes(50_000) for _ in range(20))
threads = [threading.Thread(target=work) for _ in range(4)]
[it.start() for it in threads]
[it.join() for it in threads]
ctypes.CDLL(None).malloc_stats()
"""


def arenas(first: str) -> int:
    """Return how many arenas a process has after four of its threads allocated memory."""
    code = ALLOCATE.format(first=first)
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    return done.stderr.count("Arena ")


@pytest.mark.skipif(sys.platform != "linux", reason="arenas are glibc's")
def test_threads_share_one_arena() -> None:
    assert arenas("") > 1
    assert arenas("share_arena()") == 1

"""Have enough file descriptors: each connection takes one, and shells often allow 1,024."""

from __future__ import annotations

import logging
import resource

_log = logging.getLogger(__name__)

RESERVED = 128
"""For databases, files, threads that paint, and connections that are just being refused."""


def connections_that_fit(wanted: int) -> int:
    """Allow this process as many file descriptors as it may; return how many connections that is.

    They are at most `wanted`, and fewer where the system does not allow so many.
    """
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    needed = wanted + RESERVED
    if soft == resource.RLIM_INFINITY or soft >= needed:
        return wanted
    allowed = needed if hard == resource.RLIM_INFINITY else min(hard, needed)
    resource.setrlimit(resource.RLIMIT_NOFILE, (max(soft, allowed), hard))
    fitting = max(1, allowed - RESERVED)
    if fitting < wanted:
        _log.warning("%d file descriptors are allowed: at most %d connections", allowed, fitting)
    return fitting

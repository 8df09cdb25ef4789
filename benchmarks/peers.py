"""Which peers there are to compare with."""

from __future__ import annotations

import importlib
import platform


def is_there(name: str) -> bool:
    """Say whether a module can be imported, and all that it imports."""
    try:
        importlib.import_module(name)
    except ImportError:
        return False
    return True


NOT_THERE = f"not installed on Python {platform.python_version()}"
"""What a table says of a peer that is not there."""

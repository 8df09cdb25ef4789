"""Remember what was used most recently, up to a number and a weight."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable
from typing import Generic, TypeVar

Key = TypeVar("Key")

Value = TypeVar("Value")


class Recent(Generic[Key, Value]):
    """A dictionary that forgets what was not used for longest. For one thread only."""

    def __init__(self, size: int, weight_max: int, weigh: Callable[[Value], int]) -> None:
        """Make room for `size` entries that weigh up to `weight_max` together."""
        self._size = size
        self._weight_max = weight_max
        self._weigh = weigh
        self._weight = 0
        self._entries: OrderedDict[Key, tuple[Value, int]] = OrderedDict()

    def __len__(self) -> int:
        """Return the number of entries."""
        return len(self._entries)

    @property
    def weight(self) -> int:
        """What all entries weigh."""
        return self._weight

    def get(self, key: Key) -> Value | None:
        """Return an entry, which thereby becomes the most recent one."""
        if key not in self._entries:
            return None
        self._entries.move_to_end(key)
        return self._entries[key][0]

    def put(self, key: Key, value: Value) -> None:
        """Keep an entry, and forget the oldest where there are too many; it stays if alone."""
        self.drop(key)
        self._entries[key] = value, self._weigh(value)
        self._weight += self._entries[key][1]
        while len(self) > 1 and (len(self) > self._size or self._weight > self._weight_max):
            self.drop(next(iter(self._entries)))

    def drop(self, key: Key) -> None:
        """Forget an entry, if it is there."""
        _, weight = self._entries.pop(key, (None, 0))
        self._weight -= weight

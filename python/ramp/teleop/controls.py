"""Events of keys and axes, and the action that they make."""

from __future__ import annotations

import dataclasses

from ramp.teleop.settings import AXES, DONE, GIVE_UP, KEYS, SLOW, Settings

KEY_NAMES = (*KEYS, DONE, GIVE_UP, SLOW)
"""All keys."""


@dataclasses.dataclass(frozen=True)
class Event:
    """A key that goes down or up, or an axis of a stick that moves."""

    kind: str
    """``down``, ``up`` or ``axis``."""
    name: str
    """Of the key, or of the axis."""
    value: float = 0.0
    """Of the axis, from -1 to 1."""

    def text(self, time: float) -> str:
        """The line of a file of events; ``time`` counts from the start of the turn, s."""
        value = f" {self.value:g}" if self.kind == "axis" else ""
        return f"{time:.2f} {self.kind} {self.name}{value}"


class Controls:
    """What is pressed and deflected in a turn."""

    def __init__(self, settings: Settings) -> None:
        self._slow = settings.slow
        self._down: set[str] = set()
        self._axes = dict.fromkeys(AXES, 0.0)
        self.end: str | None = None
        """The key that ended the turn."""

    def take(self, event: Event) -> None:
        """Takes one more event."""
        if event.kind == "axis":
            self._axes[event.name] = event.value
        elif event.kind == "up":
            self._down.discard(event.name)
        else:
            self._down.add(event.name)
            if event.name in (DONE, GIVE_UP) and self.end is None:
                self.end = event.name

    def action(self) -> list[float]:
        """A share of the largest speed for each axis, from -1 to 1."""
        shares = dict(self._axes)
        for key in self._down & KEYS.keys():
            axis, share = KEYS[key]
            shares[axis] += share
        factor = self._slow if SLOW in self._down else 1.0
        return [factor * min(max(shares[axis], -1.0), 1.0) for axis in AXES]

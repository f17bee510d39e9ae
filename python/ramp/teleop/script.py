"""Input from a file: timed events of keys and axes, a line each.

    # seconds  event
    0.00 down f
    1.60 up f
    1.60 axis z -0.3
    2.00 down enter
    turn
    0.00 down enter

Times are seconds of robot time since the start of the turn. A line ``turn`` begins the next turn. Each turn
ends with ``down enter`` (done) or ``down backspace`` (given up). A session in the window leaves such a file.
"""

from __future__ import annotations

import math
import pathlib

from ramp._core import InputError
from ramp.teleop.controls import KEY_NAMES, Event
from ramp.teleop.operator import View
from ramp.teleop.settings import AXES, DONE, GIVE_UP

LARGEST = 4 * 1024 * 1024
"""Of a file, bytes."""

Turn = list[tuple[float, Event]]
"""The events of a turn, each with its time, s."""


class Script:
    """The events of a file."""

    def __init__(self, file: pathlib.Path) -> None:
        """Reads a file.

        Raises:
            ramp.InputError: It cannot be read, or a line is wrong; the message names file and line.

        """
        self._turns = read(file)
        self._turn = -1
        self._next = 0

    def begin(self, what: str) -> str | None:
        """Begins the next turn; the reason why there is none."""
        self._turn, self._next = self._turn + 1, 0
        if self._turn < len(self._turns):
            return None
        return f"the input ends after turn {len(self._turns)}"

    def events(self, time: float) -> list[Event]:
        """The events of this turn up to a time, s, that were not returned before."""
        turn = self._turns[self._turn]
        first = self._next
        while self._next < len(turn) and turn[self._next][0] <= time + 1e-9:
            self._next += 1
        return [event for _, event in turn[first : self._next]]

    def show(self, view: View) -> None:
        """Nobody looks."""

    def end(self) -> None:
        """The events that are left are none: a turn ends with its last one."""


def read(file: pathlib.Path) -> list[Turn]:
    """The turns of a file."""
    try:
        with file.open("rb") as opened:
            content = opened.read(LARGEST + 1)
        if len(content) > LARGEST:
            raise InputError(f"{file} is larger than {LARGEST} bytes")
        text = content.decode("utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"{file} cannot be read: {error}") from None
    turns: list[Turn] = [[]]
    lines = text.splitlines()
    for number, line in enumerate(lines, 1):
        words = line.split("#", 1)[0].split()
        try:
            if words == ["turn"]:
                _check_end(turns[-1])
                turns.append([])
            elif words:
                _add(turns[-1], words)
        except ValueError as error:
            raise InputError(f"{file}, line {number}: {error}") from None
    try:
        _check_end(turns[-1])
    except ValueError as error:
        raise InputError(f"{file}, line {len(lines)}: {error}") from None
    return turns


def _add(turn: Turn, words: list[str]) -> None:
    """Adds the event of a line to its turn."""
    if len(words) < 3 or words[1] not in ("down", "up", "axis"):
        raise ValueError(f"found `{_plain(' '.join(words))}`, expected SECONDS down|up KEY or SECONDS axis AXIS VALUE")
    time, kind, name = _number(words[0]), words[1], words[2]
    if time < 0.0:
        raise ValueError(f"the time {time:g} s is before the start of the turn")
    if turn and time < turn[-1][0]:
        raise ValueError(f"the time {time:g} s is before that of the line above, {turn[-1][0]:g} s")
    if _ends(turn):
        raise ValueError("the turn has ended; begin the next one with the line `turn`")
    known, what = (AXES, "axis") if kind == "axis" else (KEY_NAMES, "key")
    if name not in known:
        raise ValueError(f"there is no {what} `{_plain(name)}`; there are {', '.join(known)}")
    wanted = 4 if kind == "axis" else 3
    if len(words) != wanted:
        raise ValueError(f"found {len(words)} words, expected {wanted}")
    value = _number(words[3]) if kind == "axis" else 0.0
    if abs(value) > 1.0:
        raise ValueError(f"found {value:g}, expected a number from -1 to 1")
    turn.append((time, Event(kind, name, value)))


def _ends(turn: Turn) -> bool:
    return bool(turn) and turn[-1][1] in (Event("down", DONE), Event("down", GIVE_UP))


def _check_end(turn: Turn) -> None:
    if not _ends(turn):
        raise ValueError(f"the turn has no end; its last line is expected to be `down {DONE}` or `down {GIVE_UP}`")


def _number(word: str) -> float:
    try:
        number = float(word)
    except ValueError:
        number = math.nan
    if not math.isfinite(number):
        raise ValueError(f"found `{_plain(word)}`, expected a finite number")
    return number


def _plain(word: str) -> str:
    """A word of a file within a message."""
    shown = "".join(it if it.isprintable() else "?" for it in word)
    return shown if len(shown) <= 40 else shown[:39] + "…"

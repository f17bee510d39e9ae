"""The window: both cameras, the force, robot time, and the keys. A turn is paced in real time."""

from __future__ import annotations

import time as clock
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ramp._core import InputError
from ramp.teleop import devices
from ramp.teleop.controls import KEY_NAMES, Event
from ramp.teleop.operator import View
from ramp.teleop.settings import Settings

Image = NDArray[np.uint8]

IMAGE = (480, 300)
"""Width and height of a camera's image on the screen, pixels."""
MARGIN = 16
STRIP = (480, 120)
"""Width and height of the strip of forces, pixels: the newest on the right, a column for each action."""
FULL = 30.0
"""Force at the upper edge of the strip, N."""
SIZE = (2 * IMAGE[0] + 3 * MARGIN, IMAGE[1] + 270)
LATE = 0.2
"""A twin that is further behind the clock of the wall goes on from there, s."""

OTHER_NAMES = {"return": "enter", "num_enter": "enter", "lshift": "shift", "rshift": "shift"}
"""pyglet's names of keys, where they are not ours."""

HELP = (
    "w s: away, near      a d: left, right      r f: up, down      shift: slow",
    "j l: about x      i k: about y      q e: about z      o c: open, close the gripper",
    "enter: done      backspace: give up      Closing the window gives up this turn and all that follow.",
)
COLOURS = {"force": (90, 190, 255), "down": (255, 170, 60)}
"""Of the strip: the size of the force, and its part that presses down."""


class Window:
    """A window as the source of an operator's events."""

    def __init__(self, settings: Settings, title: str) -> None:
        """Opens the window.

        Raises:
            ramp.InputError: There is no pyglet, or no display.

        """
        try:
            import pyglet
        except ImportError as error:
            raise InputError(
                f"the window needs pyglet ({error}): pip install 'ramp-benchmark[teleop]', or use --input"
            ) from error
        try:
            self._window: Any = pyglet.window.Window(*SIZE, caption=title, vsync=False)
        except Exception as error:
            raise InputError(f"the window needs a display with OpenGL ({error}); or use --input") from error
        self._pyglet = pyglet
        self._settings = settings
        self._devices = devices.find()
        self._waiting: list[Event] = []
        self._down: set[str] = set()
        self._held: tuple[dict[str, float], set[str]] = ({}, set())
        self._strip: Image = np.full((STRIP[1], STRIP[0], 3), 24, np.uint8)
        self._view: View | None = None
        self._what, self._turn = "", False
        self._time = 0.0
        self._anchor: tuple[float, float] | None = None
        self._closed = False
        self._window.push_handlers(
            on_key_press=self._press, on_key_release=self._release, on_deactivate=self._leave, on_close=self._close
        )
        self._draw()

    # Source of events

    def begin(self, what: str) -> str | None:
        """Begins a turn."""
        if self._closed:
            return "the window was closed"
        self._what, self._turn, self._anchor = what, True, None
        # What is held goes on; what was pressed before is over.
        self._waiting = [Event("down", name) for name in sorted(self._down) if name == "shift"]
        self._held = ({}, set())
        return None

    def events(self, time: float) -> list[Event]:
        """What was pressed and moved since the last call."""
        if self._closed:
            return [Event("down", "backspace")]
        self._poll()
        events, self._waiting = self._waiting, []
        return events

    def show(self, view: View) -> None:
        """Takes what is to be drawn."""
        self._view = view
        self._strip = advance(self._strip, view.wrench)

    def tick(self, time: float, seated: int, pegs: int) -> None:
        """Called now and then at a robot time in s: draws, and waits for the clock of the wall.

        The count of pegs is the referee's and not for the operator.
        """
        self._time = time
        if not self._closed:
            self._draw()
        if self._closed or not self._turn:
            return
        now = clock.monotonic()
        if self._anchor is None or now - self._anchor[0] > time - self._anchor[1] + LATE:
            self._anchor = (now, time)
        clock.sleep(max(0.0, self._anchor[0] + time - self._anchor[1] - now))

    def end(self) -> None:
        """A turn has ended: the baseline works, as fast as it can."""
        self._turn = False

    def close(self) -> None:
        """Closes the window."""
        if not self._closed:
            self._close()
        self._window.close()

    # Events of pyglet

    def _press(self, symbol: int, modifiers: int) -> bool:
        if (name := self._name(symbol)) is not None and name not in self._down:
            self._down.add(name)
            self._waiting.append(Event("down", name))
        # Escape would close the window.
        return True

    def _release(self, symbol: int, modifiers: int) -> None:
        if (name := self._name(symbol)) in self._down:
            self._down.discard(str(name))
            self._waiting.append(Event("up", str(name)))

    def _leave(self) -> None:
        """The window has lost the keyboard: nothing is pressed any more."""
        self._waiting += [Event("up", name) for name in sorted(self._down)]
        self._down.clear()

    def _close(self) -> bool:
        self._closed = True
        return True

    def _name(self, symbol: int) -> str | None:
        found = str(self._pyglet.window.key.symbol_string(symbol)).lower()
        name = OTHER_NAMES.get(found, found)
        return name if name in KEY_NAMES else None

    def _poll(self) -> None:
        """Turns what the devices hold into events."""
        axes, keys = devices.together(self._devices, self._settings)
        before, pressed = self._held
        self._waiting += [Event("axis", axis, value) for axis, value in axes.items() if before.get(axis, 0.0) != value]
        self._waiting += [Event("down", key) for key in sorted(keys - pressed)]
        self._waiting += [Event("up", key) for key in sorted(pressed - keys)]
        self._held = (axes, keys)

    # Drawing

    def _draw(self) -> None:
        window = self._window
        window.switch_to()
        window.dispatch_events()
        if self._closed:
            return
        window.clear()
        width, height = IMAGE
        top = SIZE[1] - MARGIN
        view = self._view
        for index, (camera, name) in enumerate((("wrist", "wrist camera"), ("birds-eye", "bird's-eye camera"))):
            left = MARGIN + index * (width + MARGIN)
            image = None if view is None else view.images.get(camera)
            if image is not None:
                self._blit(image, left, top - height, width, height)
            self._write(name if image is not None else f"{name}: no image", left + 6, top - 18)
        for row, text in enumerate(lines(self._what, self._turn, self._time, view)):
            self._write(text, MARGIN, top - height - 26 - 22 * row)
        left = 2 * MARGIN + width
        self._blit(self._strip, left, top - height - MARGIN - STRIP[1], *STRIP)
        scale = f"force and its part that presses down, 0 to {FULL:g} N"
        self._write(scale, left + 6, top - height - MARGIN - 16)
        others = ", ".join(it.name for it in self._devices) or "none"
        for row, text in enumerate((*HELP, f"gamepad or 6-axis mouse: {others}")):
            self._write(text, MARGIN, 84 - 22 * row)
        window.flip()

    def _blit(self, image: Image, left: int, bottom: int, width: int, height: int) -> None:
        rows, columns, _ = image.shape
        data = self._pyglet.image.ImageData(columns, rows, "RGB", image.tobytes(), pitch=-3 * columns)
        data.get_texture().blit(left, bottom, width=width, height=height)

    def _write(self, text: str, left: int, bottom: int) -> None:
        self._pyglet.text.Label(text, x=left, y=bottom, font_size=11).draw()


def lines(what: str, turn: bool, time: float, view: View | None) -> list[str]:
    """The texts beside the strip."""
    told = [f"your turn: {what}" if turn else "the baseline works", f"robot time {time:.1f} s"]
    if view is not None and turn:
        force = view.wrench[:3]
        told += [
            f"force on the world  x {force[0]:+.1f}   y {force[1]:+.1f}   z {force[2]:+.1f} N",
            "tip  x {:.1f}   y {:.1f}   z {:.1f} mm".format(*(1e3 * view.tip)),
            f"gripper {1e3 * view.width:.1f} mm",
        ]
        if view.ahead is not None:
            told.append("believed way to go  x {:+.1f}   y {:+.1f}   z {:+.1f} mm".format(*(1e3 * view.ahead)))
    return told


def advance(strip: Image, wrench: NDArray[np.float64]) -> Image:
    """The strip with one more column on its right: the force's size, and its part that presses down."""
    moved = np.roll(strip, -1, axis=1)
    moved[:, -1] = 24
    height = len(strip)
    for name, force in (("force", float(np.linalg.norm(wrench[:3]))), ("down", max(0.0, -float(wrench[2])))):
        rows = round(height * min(force / FULL, 1.0))
        if rows:
            moved[height - rows :, -1] = COLOURS[name]
    return moved

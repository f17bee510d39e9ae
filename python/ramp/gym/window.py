"""Pictures of environments for people: as arrays, or in a window."""

from __future__ import annotations

import time
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ramp._core import InputError

MODES = ["rgb_array", "human"]
"""The render modes."""

Image = NDArray[np.uint8]


def check_mode(mode: str | None) -> None:
    """Raises an error for a render mode that does not exist."""
    if mode is not None and mode not in MODES:
        raise InputError(f"render_mode: found {mode!r}, expected None, {' or '.join(map(repr, MODES))}")


class Window:
    """A window with the last picture, made with Python's own `tkinter`."""

    def __init__(self, title: str, rate: float) -> None:
        """Opens the window. `rate` is the largest number of pictures a second."""
        try:
            import tkinter
        except ImportError as error:
            raise InputError(f'render_mode="human" needs Python\'s tkinter ({error}); use "rgb_array"') from error
        try:
            self._root = tkinter.Tk()
        except tkinter.TclError as error:
            raise InputError(f'render_mode="human" needs a display ({error}); use "rgb_array"') from error
        self._root.title(title)
        self._root.protocol("WM_DELETE_WINDOW", self.close)
        self._label = tkinter.Label(self._root)
        self._label.pack()
        self._photo: Any = None
        self._period = 1.0 / rate
        self._next = 0.0
        self._open = True

    def show(self, image: Image) -> None:
        """Shows a picture, not sooner than the rate allows. Does nothing after the user closed the window."""
        if not self._open:
            return
        import tkinter

        time.sleep(max(0.0, self._next - time.monotonic()))
        self._next = time.monotonic() + self._period
        height, width, _ = image.shape
        data = b"P6 %d %d 255\n" % (width, height) + image.tobytes()
        self._photo = tkinter.PhotoImage(master=self._root, data=data, format="PPM")
        self._label.configure(image=self._photo)
        self._root.update()

    def close(self) -> None:
        """Closes the window."""
        if self._open:
            self._open = False
            self._root.destroy()

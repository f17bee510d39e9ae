"""Gamepads, by pyglet, and 6-axis mice, by pyspacemouse: what they hold, as axes and keys."""

from __future__ import annotations

from typing import Any

from ramp.teleop.settings import AXES, BUTTONS, CAP, CAP_BUTTONS, PADS, STICKS, Settings

READINGS = 16
"""Messages of a 6-axis mouse that are taken at once, at most."""


class Gamepad:
    """A gamepad of ``pyglet.input``."""

    def __init__(self, controller: Any) -> None:
        self._controller = controller
        self.name = str(controller.name)

    def read(self) -> tuple[dict[str, float], set[str]]:
        """The deflection of each axis, and the keys that are down."""
        it = self._controller
        axes = dict.fromkeys(AXES, 0.0)
        for part, (axis, share) in (STICKS | PADS).items():
            axes[axis] += share * float(getattr(it, part))
        return axes, {key for button, key in BUTTONS.items() if getattr(it, button)}


class Mouse:
    """A 6-axis mouse of ``pyspacemouse``."""

    name = "6-axis mouse"

    def __init__(self, device: Any) -> None:
        self._device = device

    def read(self) -> tuple[dict[str, float], set[str]]:
        """The deflection of each axis; such a mouse has no keys."""
        state: Any = None
        for _ in range(READINGS):
            before, state = state, self._device.read()
            if before is not None and state.t == before.t:
                break
        axes = dict.fromkeys(AXES, 0.0)
        for part, (axis, share) in CAP.items():
            axes[axis] += share * float(getattr(state, part))
        for pressed, (axis, share) in zip(state.buttons, CAP_BUTTONS, strict=False):
            axes[axis] += share * float(pressed)
        return axes, set()


Device = Gamepad | Mouse


def find() -> list[Device]:
    """The devices that are connected and work."""
    return [*_gamepads(), *_mice()]


def _gamepads() -> list[Device]:
    import pyglet

    try:
        controllers = pyglet.input.get_controllers()
        for controller in controllers:
            controller.open()
    except Exception:
        # Not readable, or a system without such devices.
        return []
    return [Gamepad(it) for it in controllers]


def _mice() -> list[Device]:
    try:
        import pyspacemouse

        return [Mouse(pyspacemouse.open(axis_convention=pyspacemouse.AxisConvention.ROS))]
    except Exception:
        # Not installed, none connected, or not readable.
        return []


def together(devices: list[Device], settings: Settings) -> tuple[dict[str, float], set[str]]:
    """The sum of all devices: deflections from -1 to 1 in steps of 0.01, and the keys that are down."""
    axes, keys = dict.fromkeys(AXES, 0.0), set()
    for device in devices:
        theirs, pressed = device.read()
        keys |= pressed
        for axis, value in theirs.items():
            axes[axis] += value if abs(value) > settings.dead_zone else 0.0
    return {axis: round(min(max(value, -1.0), 1.0), 2) for axis, value in axes.items()}, keys

"""What may be tuned: speeds, rates, keys, axes and buttons."""

from __future__ import annotations

import dataclasses

AXES = ("x", "y", "z", "about-x", "about-y", "about-z", "gripper")
"""What an action moves: the tip along and about the axes of the world, and the fingers. ``x`` points away from the
base, ``y`` to its left, ``z`` up; the gripper opens for positive values."""

DONE, GIVE_UP, SLOW = "enter", "backspace", "shift"
"""Keys that are no axes: the turn is done; the turn is given up; slow while held."""

KEYS: dict[str, tuple[str, float]] = {
    "w": ("x", 1.0), "s": ("x", -1.0),
    "a": ("y", 1.0), "d": ("y", -1.0),
    "r": ("z", 1.0), "f": ("z", -1.0),
    "j": ("about-x", 1.0), "l": ("about-x", -1.0),
    "i": ("about-y", 1.0), "k": ("about-y", -1.0),
    "q": ("about-z", 1.0), "e": ("about-z", -1.0),
    "o": ("gripper", 1.0), "c": ("gripper", -1.0),
}  # fmt: skip
"""Keys of the axes: the axis, and the share of its largest speed."""

STICKS: dict[str, tuple[str, float]] = {
    "lefty": ("x", 1.0), "leftx": ("y", -1.0), "righty": ("z", 1.0), "rightx": ("about-z", -1.0),
    "dpady": ("about-y", 1.0), "dpadx": ("about-x", -1.0),
}  # fmt: skip
"""Sticks and directions of a gamepad, as pyglet names them, likewise."""

PADS: dict[str, tuple[str, float]] = {"rightshoulder": ("gripper", 1.0), "leftshoulder": ("gripper", -1.0)}
"""Buttons of a gamepad that move an axis."""

BUTTONS: dict[str, str] = {"a": DONE, "b": GIVE_UP, "x": SLOW}
"""Buttons of a gamepad that act as keys."""

CAP: dict[str, tuple[str, float]] = {
    "x": ("x", 1.0), "y": ("y", 1.0), "z": ("z", 1.0),
    "roll": ("about-x", 1.0), "pitch": ("about-y", 1.0), "yaw": ("about-z", 1.0),
}  # fmt: skip
"""Movements of the cap of a 6-axis mouse, as pyspacemouse names them in its convention ``ROS``: x forward, y left, z
up."""

CAP_BUTTONS: tuple[tuple[str, float], ...] = (("gripper", -1.0), ("gripper", 1.0))
"""What the left and the right button of a 6-axis mouse move."""


@dataclasses.dataclass(frozen=True)
class Settings:
    """Numbers of a session."""

    rate: int = 20
    """Actions a second; it divides 1000."""
    speed: float = 0.03
    """Largest speed along each axis within an action of the plan, m/s."""
    turn_speed: float = 0.3
    """And about each axis, rad/s."""
    goal_speed: float = 0.12
    """Largest speed along each axis when a goal is built by hand, m/s."""
    goal_turn_speed: float = 0.6
    """And about each axis, rad/s."""
    slow: float = 0.2
    """Share of the speeds while the key ``shift`` is held."""
    dead_zone: float = 0.08
    """Share of the deflection of a stick or a cap that counts as none."""
    image_every: int = 2
    """Actions from one pair of images to the next."""
    image_delay: int = 1
    """Pairs of images that are on their way from the cameras while the arm goes on."""
    image_width: int = 320
    """Pixels in a row of an image."""
    demonstration_size: int = 96
    """Pixels along each side of an image of the demonstration, as ``ramp demos`` has it."""

    @property
    def periods(self) -> int:
        """Control periods of 1 ms in an action."""
        return 1000 // self.rate

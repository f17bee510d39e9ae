"""Finders of parts in Python that read the baseline's images.

>>> import ramp
>>> def nothing(sight):
...     return []
>>> ramp.run("easy-1", track="colour", world="ideal", finder=nothing).counted
0
"""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Callable, Iterable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ramp._core import InputError
from ramp.goal import Goal
from ramp.planner import name_of


def _pose(text: dict[str, Any]) -> NDArray[np.float64]:
    return np.array([*text["position"], *text["quat_wxyz"]])


@dataclasses.dataclass(frozen=True)
class Believed:
    """A part as it is believed to be at the time of an image."""

    part: str
    """Its name."""
    pose: NDArray[np.float64]
    """Its pose in the world: x, y, z in m, quaternion w, x, y, z, shape (7,)."""
    covariance: NDArray[np.float64]
    """Of a shift (m) and turn (rad) about its origin, axes of the world, shape (6, 6)."""
    held: bool
    """Whether it is between the fingers."""
    lying: dict[str, Any] | None
    """What is known of its height and tilt: ``height`` (m), ``flipped``, ``sigma`` (m, rad)."""


@dataclasses.dataclass(frozen=True)
class Sight:
    """An image, and what is believed to be in it."""

    goal: Goal
    """The goal, with its kit."""
    camera: str
    """``wrist`` or ``birds-eye``."""
    time: float
    """Robot time in the middle of the exposure, s."""
    pixels: NDArray[np.uint8]
    """Red, green and blue of each pixel, gamma 2.2, shape (800, 1280, 3)."""
    depth: NDArray[np.uint16] | None
    """On the track ``depth``: the distance along the optical axis, 0.1 mm, 0 where there is none, shape (800, 1280)."""
    focal: NDArray[np.float64]
    """Focal lengths along x and y, pixels, shape (2,)."""
    centre: NDArray[np.float64]
    """Principal point, pixels; the middle of the first pixel is at 0.5, shape (2,)."""
    distortion: NDArray[np.float64]
    """Brown's coefficients k1, k2, p1, p2, k3, shape (5,)."""
    camera_pose: NDArray[np.float64]
    """Pose of the optical frame in the world, as it is known by now, shape (7,)."""
    tip: NDArray[np.float64]
    """Pose of the tip in the world, shape (7,)."""
    parts: list[Believed]
    """All parts."""
    holders: dict[str, NDArray[np.float64]]
    """Poses of the holders of pegs in the world, shape (7,) each."""
    fingers: float
    """Distance between the fingers, m."""


@dataclasses.dataclass(frozen=True)
class Found:
    """A part that was found."""

    part: str
    """Its name."""
    pose: ArrayLike
    """Its pose in the optical frame (z forward, x right, y down), shape (7,)."""
    sigma: tuple[float, float] | None = None
    """Standard deviations of its place along each axis, m, and of its turn about each, rad."""
    covariance: ArrayLike | None = None
    """In place of them: of a shift and turn about its origin, axes of the optical frame, shape (6, 6)."""


@dataclasses.dataclass(frozen=True)
class Absent:
    """A part that is not where it is believed to be."""

    part: str
    """Its name."""


Finder = Callable[[Sight], Iterable[Found | Absent]]
"""Says where parts are in an image. The clamped beam tells the baseline where its camera is."""


def _sight(goal: Goal, text: str, pixels: bytes, depth: bytes | None) -> Sight:
    question = json.loads(text)
    image = question["image"]
    shape = image["height"], image["width"]
    parts = [
        Believed(it["part"], _pose(it["x_wp"]), np.array(it["covariance"]), it["held"], it["lying"])
        for it in question["parts"]
    ]
    return Sight(
        goal=goal,
        camera=image["camera"],
        time=image["time"],
        pixels=np.frombuffer(pixels, np.uint8).reshape(*shape, 3),
        depth=None if depth is None else np.frombuffer(depth, "<u2").reshape(shape),
        focal=np.array(image["focal"]),
        centre=np.array(image["centre"]),
        distortion=np.array(image["distortion"]),
        camera_pose=_pose(image["x_wc"]),
        tip=_pose(image["x_wt"]),
        parts=parts,
        holders={name: _pose(x) for name, x in question["holders"].items()},
        fingers=question["fingers"],
    )


def _part(found: Found) -> dict[str, Any]:
    pose = np.asarray(found.pose, float)
    if pose.shape != (7,):
        raise InputError(f"the finder gives {found.part} a pose of shape {pose.shape}, and (7,) is expected")
    x_cp = {"position": pose[:3].tolist(), "quat_wxyz": pose[3:].tolist()}
    part: dict[str, Any] = {"part": found.part, "x_cp": x_cp}
    if found.sigma is not None:
        part["sigma"] = [float(it) for it in found.sigma]
    if found.covariance is not None:
        part["covariance"] = np.asarray(found.covariance, float).tolist()
    return part


def asker(finder: Finder, goal: Goal) -> Callable[[str, bytes, bytes | None], str]:
    """Asks a finder by JSON and bytes."""

    def ask(text: str, pixels: bytes, depth: bytes | None) -> str:
        found, absent = [], []
        for it in finder(_sight(goal, text, pixels, depth)):
            if isinstance(it, Absent):
                absent.append(it.part)
            elif isinstance(it, Found):
                found.append(_part(it))
            else:
                raise InputError(f"the finder gave a {type(it).__name__}, and ramp.Found or ramp.Absent is expected")
        return json.dumps({"parts": found, "absent": absent})

    return ask


def finder_name(finder: Finder) -> str:
    """Its name in results, with the start of the hash of its source where Python has it."""
    return name_of("finder", finder)

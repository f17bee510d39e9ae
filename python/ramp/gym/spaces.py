"""Spaces of observations and actions, and the settings that both kinds of environments share."""

from __future__ import annotations

import math
import os
from collections.abc import Sequence
from typing import Any

import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from ramp._core import MAX_SEED, Env, InputError, benchmark, integer
from ramp.goal import Goal, as_goal

# Limits of each field, above all values in practice: ranges and speeds of the arm, table size, forces of the
# reflex.
LIMITS = {
    "positions": 4.0,
    "velocities": 4.0,
    "torques": 100.0,
    "tip": 2.0,
    "width": 0.1,
    "wrench": 500.0,
    "lead": 4.0,
    "touch_force": 1000.0,
    "touch_centre": 0.1,
    "part": 5.0,
    "error": 7.0,
    "parts": 5.0,
    "time": 1.0,
}


UNITS = {
    "positions": 1.0,
    "velocities": 0.5,
    "torques": 10.0,
    "tip": 1.0,
    "width": 0.08,
    "wrench": 10.0,
    "lead": 0.01,
    "touch_force": 10.0,
    "touch_centre": 0.01,
    "part": 1.0,
    "error": 0.01,
    "parts": 1.0,
    "time": 1.0,
}
"""With ``normalise``, each field is in these units: of the size that its values have in ordinary work. A unit
per field, in rad, rad/s, N·m, m, N and s; rotation vectors have 0.01 rad."""

SIZES = (16, 512)
"""Smallest and largest side of an image, pixels."""


def check_seed(seed: int | None) -> None:
    """Raises an error for a seed that the simulator cannot take."""
    if seed is not None:
        integer("seed", seed, 0, MAX_SEED)


def check_options(options: dict[str, Any] | None, known: Sequence[str] = ()) -> None:
    """Raises an error for an option of ``reset`` that has no effect."""
    for name in options or {}:
        if name not in known:
            expected = ", ".join(known) or "none"
            raise InputError(f"`reset` has no option {name!r}; its options: {expected}")


def with_touch(world: str | os.PathLike[str], touch: bool) -> str:
    """The world, with tactile sensors in the fingers if ``touch``."""
    name = os.fspath(world)
    if not touch or name.endswith("+touch"):
        return name
    if name not in benchmark().world_names():
        raise InputError("`touch` is for worlds of the program; a world file has sensors with `touch.fitted` 1")
    return f"{name}+touch"


def make_core(
    skill: str | None,
    goals: Goals,
    *,
    track: str,
    world: str | os.PathLike[str],
    start: str | os.PathLike[str],
    begin: str,
    touch: bool,
    whole_scene: bool,
    frame: str,
    cameras: Sequence[str],
    image_size: int,
    depth: bool,
    settings: dict[str, Any],
) -> Env:
    """The compiled environment behind both kinds."""
    integer("image_size", image_size, *SIZES)
    first, number = settings["starts"]
    settings["starts"] = (integer("starts", first, 0, MAX_SEED), integer("starts", number, 0, MAX_SEED))
    views = [(camera, image_size, depth) for camera in cameras]
    if len(set(cameras)) != len(cameras):
        raise InputError("a camera is named twice")
    return Env(
        benchmark(),
        skill,
        [goal.source for goal in as_goals(goals)],
        track=track,
        world=with_touch(world, touch),
        start=os.fspath(start),
        begin=begin,
        whole_scene=whole_scene,
        frame=frame,
        settings={**settings, "views": views},
    )


Goals = str | os.PathLike[str] | Goal | Sequence[str | os.PathLike[str] | Goal]
"""Goals: a sequence, or one alone."""


def as_goals(goals: Goals) -> list[Goal]:
    """The goals of a sequence, or the one that is named alone."""
    several = [goals] if isinstance(goals, str | os.PathLike | Goal) else goals
    return [as_goal(goal) for goal in several]


def steps(limit: float, core: Env) -> int:
    """Actions within a robot time of ``limit`` (s)."""
    return math.ceil(round(1000.0 * limit) / core.periods)


def observation_space(
    core: Env, cameras: Sequence[str], size: int, depth: bool, normalise: bool = False
) -> spaces.Dict:
    """The space of observations: a box of 32-bit floats per field, and one per image."""
    boxes: dict[str, spaces.Space[Any]] = {}
    for name, shape, _, _ in core.fields():
        limit = LIMITS[name] / (UNITS[name] if normalise else 1.0)
        boxes[name] = spaces.Box(-limit, limit, tuple(shape), np.float32)
    for camera in cameras:
        boxes[camera] = spaces.Box(0, 255, (size, size, 3), np.uint8)
        if depth:
            boxes[f"{camera}-depth"] = spaces.Box(0.0, 10.0, (size, size), np.float32)
    return spaces.Dict(boxes)


def action_space(core: Env) -> spaces.Space[NDArray[np.float32]]:
    """The space of actions."""
    bounds = np.array(core.bounds(), dtype=np.float32)
    space: spaces.Space[Any] = spaces.Box(bounds[:, 0], bounds[:, 1], dtype=np.float32)
    return space


class Cutter:
    """Splits rows of numbers into the fields of an observation."""

    def __init__(self, core: Env, normalise: bool = False) -> None:
        self.pieces = [
            (name, slice(offset, offset + math.prod(shape)), tuple(shape)) for name, shape, offset, _ in core.fields()
        ]
        limits = [np.full(math.prod(shape), LIMITS[name], np.float32) for name, shape, _, _ in core.fields()]
        self.limits = np.concatenate(limits)
        units = [np.full(math.prod(shape), UNITS[name], np.float32) for name, shape, _, _ in core.fields()]
        self.units = np.concatenate(units) if normalise else None

    def cut(self, rows: NDArray[np.float32]) -> dict[str, NDArray[np.float32]]:
        """The fields of ``rows`` along its last axis, clipped to their limits and scaled in place."""
        np.clip(rows, -self.limits, self.limits, out=rows)
        if self.units is not None:
            rows /= self.units
        return {name: rows[..., at].reshape(rows.shape[:-1] + shape) for name, at, shape in self.pieces}

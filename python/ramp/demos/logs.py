"""Demonstrations from logs: an episode runs again from its log, and is sampled at a rate."""

from __future__ import annotations

import json
import pathlib
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ramp._core import InputError, log_facts, play_log
from ramp.demos.episode import Description, Episode

FIELDS = {"positions": 7, "velocities": 7, "torques": 7, "tip": 7, "width": 1, "wrench": 6}
"""What the robot senses, and its numbers."""

TOUCH = {"touch_force": 6, "touch_centre": 4}
"""What tactile sensors add: of each finger the force (3) and the centre of pressure (2)."""

ACTIONS = (*(f"joint.{it}" for it in range(7)), "width")
"""Numbers of an action, those of the environments' ``raw`` ones: the positions to which the joints were told to go,
rad, and the width of the gripper, m."""

PERIODS = 1000
"""Control periods a second."""


def has_touch(log: pathlib.Path) -> bool:
    """Whether the fingers had tactile sensors in the episode of a log."""
    return bool(json.loads(log_facts(str(log)))["touch"])


def describe(
    rate: int, kind: str, source: dict[str, Any], *, size: int = 0, depth: bool = False, touch: bool = False
) -> Description:
    """The description of a data set that is made of logs."""
    if PERIODS % rate:
        raise InputError(f"the rate {rate} Hz does not divide {PERIODS}, the control periods of a second")
    fields = FIELDS | (TOUCH if touch else {})
    return Description(rate, fields, ACTIONS, size, depth, {"kind": kind, **source})


class Samples:
    """The samples of one episode."""

    def __init__(self) -> None:
        self.rows: list[dict[str, Any]] = []

    def __call__(self, sample: dict[str, Any]) -> None:
        """Takes one more."""
        self.rows.append(sample)

    def field(self, name: str) -> NDArray[np.float32]:
        """All values of a field, shape (T + 1, n)."""
        return np.stack([row[name] for row in self.rows]).astype(np.float32)


def sample(log: pathlib.Path, description: Description) -> tuple[dict[str, Any], Samples]:
    """Runs a log again: what it tells and how the replay compares, and the samples."""
    samples = Samples()
    size = description.size or None
    periods = PERIODS // description.rate
    told: dict[str, Any] = json.loads(play_log(str(log), samples, periods=periods, size=size, depth=description.depth))
    return told, samples


def targets(samples: Samples) -> NDArray[np.float32]:
    """The action of each step: where the arm was told to go by the end of it."""
    return samples.field("target")[1:]


def record(log: pathlib.Path, description: Description) -> Episode:
    """The episode of a log."""
    told, samples = sample(log, description)
    if not told["equal"]:
        raise InputError(f"{log}: this program does not repeat the episode to the last bit: {told['differences'][0]}")
    if len(samples.rows) < 2:
        raise InputError(f"{log}: the episode is shorter than a step")
    actions = targets(samples)
    times = np.array([row["time"] for row in samples.rows])
    kept = ("seed", "goal", "world", "start", "track", "agent", "version", "completion", "state", "sha256")
    facts = {key: told[key] for key in kept}
    facts["task"] = f"build the frame {told['goal']}"
    facts["success"] = told["completion"] == 1.0
    facts["actions"] = [
        {"frame": max(int(np.searchsorted(times, it["t"] + 1e-9)) - 1, 0), "action": it["action"]}
        for it in told["actions"]
    ]
    fields = {name: samples.field(name) for name in description.fields}
    images = {key: np.stack([row[it] for row in samples.rows]) for it, key in description.cameras().items()}
    depths = {key: np.stack([row[f"{it}-depth"] for row in samples.rows]) for it, key in description.deep().items()}
    return Episode(fields, images, depths, actions, rewards_of(times, told["pegs"]), facts)


def rewards_of(times: NDArray[np.float64], seated: list[float | None]) -> NDArray[np.float32]:
    """The share of the goal's pegs that begin to count in each step.

    ``times`` (s) are those of the samples, shape (T + 1,); ``seated`` since when each peg counts, s.
    """
    rewards = np.zeros(len(times) - 1, np.float32)
    for time in seated:
        if time is not None:
            step = int(np.searchsorted(times, time - 1e-9)) - 1
            rewards[min(max(step, 0), len(rewards) - 1)] += 1.0 / len(seated)
    return rewards

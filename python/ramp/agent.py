"""Agents and skills in Python: classes to inherit from."""

from __future__ import annotations

import dataclasses
import json
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from ramp._core import Robot, check_event
from ramp.goal import Goal

Array = NDArray[np.float64]

EventKind = Literal[
    "action_begun",
    "action_ended",
    "fault",
    "retry",
    "search",
    "touched",
    "seen",
    "diagnosis",
    "replan",
    "motion",
    "unusual_grasp",
    "not_rehearsed",
    "clipped",
    "note",
]
"""The kinds of events that an agent reports; their fields are in the reference of results."""


class Agent:
    """Builds a goal. Inherit from it, and write :meth:`run`.

    >>> class Idle(ramp.Agent):
    ...     def run(self, robot, goal):
    ...         pass
    >>> ramp.run("easy-1", agent=Idle(), track="state").counted
    0
    """

    name: str = "agent"
    """Its name in results: letters, digits and ``. _ + -``."""
    version: str = "1"
    """Its version in results."""

    def __init__(self) -> None:
        self.events: list[dict[str, Any]] = []

    def run(self, robot: Robot, goal: Goal) -> None:
        """Works on the goal. Returning ends the episode.

        ``robot`` works until this returns. It raises :class:`ramp.RobotStopped` when a limit of the arm is
        broken or the episode's time is over; whatever else is raised here passes through :func:`ramp.run`.
        :class:`ramp.Recovered` tells that the arm stopped and is ready again: catch it to go on.
        """
        raise NotImplementedError

    def report(self, time: float, kind: EventKind, **fields: Any) -> None:
        """Adds an event to the result.

        Args:
            time: Robot time, s.
            kind: The kind of the event, such as ``diagnosis``.
            fields: The fields of that kind, such as ``cause``, ``part`` and ``evidence``. Lengths are in m.

        Raises:
            ramp.InputError: The kind or a field is wrong, or the event is too long.

        >>> agent = ramp.Agent()
        >>> agent.report(1.5, "diagnosis", cause="jam", part="b4", evidence="25 N")
        >>> agent.report(2.0, "action_begun", action="push", beam="b4", link="b4l2")

        """
        event = {"t": float(time), "kind": kind, **fields}
        check_event(json.dumps(event))
        self.__dict__.setdefault("events", []).append(event)

    def note(self, time: float, text: str) -> None:
        """Adds a text for a person to the result, at a robot time in s: an event of the kind ``note``."""
        printable = "".join(c if c.isprintable() else " " for c in str(text))
        self.report(time, "note", text=printable[:200])


@dataclasses.dataclass(frozen=True)
class Task:
    """What a skill is asked to do, and what the agent knows as it begins."""

    kind: str
    """The kind of the action, such as ``fasten``."""
    action: str
    """The action in words."""
    part: str
    """The part that it works on."""
    part_pose: Array
    """Believed pose of the part in the world, shape (7,): x, y, z in m, quaternion w, x, y, z."""
    goal_pose: Array
    """Believed pose of its place in the world, likewise."""
    posture: Array
    """Joint positions, rad, shape (7,)."""
    width: float
    """What the gripper was told last: the distance between the fingers, m."""
    force: float
    """And the force of each finger, N."""
    held_pose: Array | None
    """Pose of what is held in the tip's frame, likewise; none with an empty hand."""
    held_mass: float | None
    """kg."""
    held_centre: Array | None
    """Its centre of mass in its own frame, m, shape (3,)."""


class Skill:
    """Carries out fine actions of one kind inside the baseline. Inherit from it, and write :meth:`work`.

    The baseline brings the hand to where the action begins, and lets go of what is held afterwards.
    """

    name: str = "own-skill"
    """Its name in results: the agent is then called ``baseline+fasten-by-own-skill.0a1b2c3d``, with the start of the
    hash of the skill's source."""
    serves: str = "fasten"
    """The kind of action: assemble-square, assemble-angled, assemble-through, assemble-deep, assemble-cap,
    lay-down, slide, fasten or push."""

    def work(self, robot: Robot, task: Task) -> str | None:
        """Carries out the task. Returns nothing when it is done, or the reason why it gave up."""
        raise NotImplementedError

    def rehearse(self, task: Task) -> list[list[dict[str, Any]]] | None:
        """The motions that :meth:`work` will ask for: alternatives, the preferred one first.

        It is called when a plan is made, before anything moves.

        Each alternative is a list of motions from :class:`Motion`. A plan in which none of them is possible
        is changed. Without this method the action counts as possible, and an event says that the skill is not
        rehearsed.

        >>> class Press(ramp.Skill):
        ...     def rehearse(self, task):
        ...         down = task.goal_pose.copy()
        ...         down[3:] = [0.0, 1.0, 0.0, 0.0]
        ...         down[2] += 0.02
        ...         return [[ramp.Motion.straight(down, task.width, contact=True), ramp.Motion.retreat()]]
        """
        return None

    def run(self, robot: Robot, task: dict[str, Any]) -> str | None:
        """Called by the baseline."""
        return self.work(robot, Task(**task))

    def outline(self, task: dict[str, Any]) -> str | None:
        """Called by the baseline when it rehearses a plan."""
        alternatives = self.rehearse(Task(**task))
        return None if alternatives is None else json.dumps(alternatives)


class Motion:
    """Motions of a rehearsed skill. Poses of the tip (world): x, y, z (m) and a quaternion w, x, y, z."""

    @staticmethod
    def travel(pose: Array, width: float) -> dict[str, Any]:
        """Through free space, around everything but the held part, with the fingers ``width`` (m) apart."""
        return {"travel": {"x_wt": _pose(pose), "open": float(width)}}

    @staticmethod
    def straight(pose: Array, width: float, around: str | None = None, contact: bool = False) -> dict[str, Any]:
        """In a straight line. Arm and hand may touch the part ``around``; ``contact``: an insertion."""
        straight = {"x_wt": _pose(pose), "open": float(width), "around": around, "contact": contact}
        return {"straight": straight}

    @staticmethod
    def contact(distance: float) -> dict[str, Any]:
        """A short motion in contact over ``distance`` (m)."""
        return {"contact": {"distance": float(distance)}}

    @staticmethod
    def fingers(stroke: float) -> dict[str, Any]:
        """The fingers open or close by ``stroke`` (m)."""
        return {"fingers": {"stroke": float(stroke)}}

    @staticmethod
    def retreat() -> dict[str, Any]:
        """Straight up to travelling height."""
        return {"retreat": {}}


def _pose(pose: Array) -> dict[str, list[float]]:
    numbers = [float(number) for number in pose]
    return {"position": numbers[:3], "quat_wxyz": numbers[3:]}

"""Agents and skills in Python: classes to inherit from."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ramp._core import Robot
from ramp.goal import Goal

Array = NDArray[np.float64]


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
        self.events: list[tuple[float, str]] = []

    def run(self, robot: Robot, goal: Goal) -> None:
        """Works on the goal. Returning ends the episode.

        ``robot`` works until this returns. It raises :class:`ramp.RobotStopped` when a limit of the arm is broken or
        the episode's time is over; whatever else is raised here passes through :func:`ramp.run`.
        """
        raise NotImplementedError

    def note(self, time: float, what: str) -> None:
        """Adds what happened, at a robot time in s, to the result."""
        self.__dict__.setdefault("events", []).append((float(time), str(what)))


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
    """Its name in results: the agent is then called ``baseline+fasten-by-own-skill``."""
    serves: str = "fasten"
    """The kind of action: assemble-square, assemble-angled, assemble-through, assemble-deep, assemble-cap, lay-down,
    slide, fasten or push."""

    def work(self, robot: Robot, task: Task) -> str | None:
        """Brings about what the task asks for. Returns nothing when it is done, or in words why it gave up."""
        raise NotImplementedError

    def run(self, robot: Robot, task: dict[str, Any]) -> str | None:
        """Called by the baseline."""
        return self.work(robot, Task(**task))

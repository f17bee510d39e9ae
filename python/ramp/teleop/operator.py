"""The operator at work: an agent for a goal, or a skill for the actions of one kind."""

from __future__ import annotations

import dataclasses
import sys
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from ramp._core import Observation, Recovered, Refused, Robot
from ramp.agent import Agent, Skill, Task
from ramp.driver import Driver
from ramp.goal import Goal
from ramp.teleop.controls import Controls, Event
from ramp.teleop.settings import GIVE_UP, Settings

GIVEN_UP = "given up by the operator"
"""What the result says of a turn that was given up."""


@dataclasses.dataclass
class View:
    """What the operator sees after an action. All of it comes from the track."""

    time: float
    """Robot time since the start of the episode, s."""
    wrench: NDArray[np.float64]
    """Wrench of the hand on the world since the start of the turn, axes of the world: N, N·m, shape (6,)."""
    tip: NDArray[np.float64]
    """Position of the tip in the world, m, shape (3,)."""
    width: float
    """Distance between the fingers, m."""
    ahead: NDArray[np.float64] | None
    """From the part to its believed place, axes of the world, m, shape (3,); none for a goal."""
    images: dict[str, NDArray[np.uint8]]
    """The newest image of each camera; none where the track has none."""


class Source(Protocol):
    """Where events come from: a file, or a person at a window."""

    def begin(self, what: str) -> str | None:
        """Begins a turn, which is about ``what``; the reason why there is none."""

    def events(self, time: float) -> list[Event]:
        """The events up to a time since the start of the turn, s, that were not returned before."""

    def show(self, view: View) -> None:
        """Shows what the operator sees."""

    def end(self) -> None:
        """Ends the turn."""


class Cameras:
    """The images that the operator sees: the arm goes on while they are on their way."""

    NAMES = ("wrist", "birds-eye")

    def __init__(self, settings: Settings) -> None:
        self._settings = settings
        self._pending = 0
        self._steps = 0
        self.images: dict[str, NDArray[np.uint8]] = {}

    def step(self, robot: Robot) -> None:
        """Takes a pair of images when it is due."""
        if self._steps % self._settings.image_every == 0:
            robot.expose()
            self._pending += 1
            if self._pending > self._settings.image_delay:
                self._look(robot)
        self._steps += 1

    def finish(self, robot: Robot) -> None:
        """Takes what is on its way, so that the next image of the robot is a new one."""
        while self._pending:
            self._look(robot)
        self._steps = 0

    def _look(self, robot: Robot) -> None:
        self._pending -= 1
        for name in self.NAMES:
            try:
                self.images[name] = robot.look(name, size=self._settings.image_width).pixels
            except Refused:
                # The camera has stopped.
                self.images.pop(name, None)


class Operator:
    """Drives the robot by the events of a source."""

    def __init__(self, source: Source, settings: Settings, sees: bool) -> None:
        """``sees`` is true if the track gives images."""
        self.settings = settings
        self.lines: list[str] = []
        """The events of all turns so far, as lines of a file."""
        self._turns = 0
        self._source = source
        self._cameras = Cameras(settings) if sees else None

    def drive(
        self, robot: Robot, driver: Driver, what: str, numbers: int, way: NDArray[np.float64] | None
    ) -> str | None:
        """Drives until the turn ends. Returns nothing when it is done, or the reason why it was given up.

        Args:
            robot: The robot.
            driver: Turns actions into commands.
            what: What the turn is about, in words.
            numbers: How many numbers an action has.
            way: From the part to its believed place at the start, axes of the world, m.

        """
        if (reason := self._source.begin(what)) is not None:
            return reason
        if self._turns:
            self.lines.append("turn")
        self._turns += 1
        self.lines.append(f"# {what}")
        print(f"turn {self._turns}: {what}", file=sys.stderr, flush=True)
        end = self._turn(robot, driver, numbers, way)
        self._source.end()
        if self._cameras is not None:
            self._cameras.finish(robot)
        return GIVEN_UP if end == GIVE_UP else None

    def _turn(self, robot: Robot, driver: Driver, numbers: int, way: NDArray[np.float64] | None) -> str:
        """Acts until a key ends the turn; that key."""
        controls = Controls(self.settings)
        seen = first = robot.observe()
        steps = 0
        while True:
            self._show(seen, first, way)
            time = steps * self.settings.periods / 1000.0
            for event in self._source.events(time):
                if controls.end is None:
                    controls.take(event)
                    self.lines.append(event.text(time))
            if controls.end is not None:
                return controls.end
            try:
                seen = driver.act(robot, controls.action()[:numbers], self.settings.periods)
            except Recovered:
                seen = robot.observe()
            if self._cameras is not None:
                self._cameras.step(robot)
            steps += 1

    def _show(self, seen: Observation, first: Observation, way: NDArray[np.float64] | None) -> None:
        ahead = None if way is None else way - (seen.tip_position - first.tip_position)
        images = {} if self._cameras is None else dict(self._cameras.images)
        wrench = seen.wrench - first.wrench
        self._source.show(View(seen.time, wrench, seen.tip_position, seen.width, ahead, images))


class TeleopSkill(Skill):
    """Each action of one kind is a turn of the operator; the baseline carries out all others."""

    name = "teleop"

    def __init__(self, serves: str, operator: Operator) -> None:
        self.serves = serves
        self._operator = operator

    def work(self, robot: Robot, task: Task) -> str | None:
        """One turn."""
        it = self._operator.settings
        driver = Driver(robot, task=task, speed=it.speed, turn_speed=it.turn_speed)
        way = task.goal_pose[:3] - task.part_pose[:3]
        return self._operator.drive(robot, driver, task.action, 6, way)


class TeleopAgent(Agent):
    """The operator builds a whole goal, in one turn."""

    name = "teleop"
    version = "1"

    def __init__(self, operator: Operator) -> None:
        super().__init__()
        self._operator = operator

    def run(self, robot: Robot, goal: Goal) -> None:
        """The turn; the episode ends with it."""
        it = self._operator.settings
        driver = Driver(robot, gripper=True, speed=it.goal_speed, turn_speed=it.goal_turn_speed)
        reason = self._operator.drive(robot, driver, f"build the frame {goal.name}", 7, None)
        if reason is not None:
            self.note(robot.observe().time, reason)

"""The linear policy for `fasten` with eyes: images of the wrist camera tell where the hole is.

While the peg is over the plate, each image gives a place of the hole (:mod:`ramp.policies.localise`). The
policy (:mod:`ramp.policies.fasten`) then works as ever, with this place instead of the believed one.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ramp._core import Driver, Refused, Robot, benchmark
from ramp.agent import Skill, Task
from ramp.policies import fasten, localise
from ramp.policies.convolution import Weights
from ramp.policies.fasten import Array, Rows

FINE = 0.4e-3
"""Error of a place that an image right over the hole tells, m."""
SHARE = 0.1
"""And how much of the distance it is more."""
PATIENCE = 2.5
"""Time after which a peg that is not in the hole seeks it where it is believed, s: the images may have been wrong."""
INSIDE = 30.0e-3
"""Below this height above its place, m, a peg is in the hole."""
RESTING = 1.0e-4
"""A peg that sinks by less than this in 50 ms, m, while it is pressed, is at rest."""
PRESSED = 10.0
"""Force downwards on a peg that is pressed, N."""
NEARLY = 2.0e-3
"""A peg that rests lower than this above its place, m, counts as seated: its place is not known better."""


class Sight:
    """Where holes are, as several images tell together. Rows are environments."""

    def __init__(self, count: int, weights: Weights | None = None) -> None:
        self.weights = localise.load() if weights is None else weights
        self.sum, self.weight = np.zeros((count, 2)), np.zeros(count)
        self.steps = 0

    def add(self, which: NDArray[np.intp], images: localise.Images, errors: Array, tips: Array) -> None:
        """Takes images in.

        Args:
            which: The rows that have one.
            images: As of :func:`localise.cut`, shape (count, SIDE, SIDE, 3).
            errors: The believed ways from peg to place at that moment, m, shape (count, 3).
            tips: Poses of the tip at that moment, shape (count, 7).

        """
        found = localise.locate(self.weights, images, -errors[:, 2], tips)
        weight = 1.0 / (FINE**2 + (SHARE * np.hypot(*found.T)) ** 2)
        self.sum[which] += weight[:, None] * (found - errors[:, :2])
        self.weight[which] += weight

    def corrected(self, errors: Array) -> Array:
        """Ways from peg to place as images tell them, m, shape (count, 3 or more); once for each action."""
        self.steps += 1
        off = self.sum / np.maximum(self.weight, 1e-9)[:, None]
        if self.steps > PATIENCE * fasten.RATE:
            off[-errors[:, 2] > INSIDE] = 0.0
        errors = errors.copy()
        errors[:, :2] += off
        return errors


def aim(count: int, weights: Weights | None = None) -> fasten.Aim:
    """For :func:`ramp.policies.fasten.episodes`: errors that the images in observations set right."""
    sight = Sight(count, weights)

    def corrected(seen: Rows) -> Rows:
        errors = np.asarray(seen["error"], float)
        over = np.flatnonzero(-errors[:, 2] > localise.OVER)
        if len(over) > 0:
            images = localise.cut(seen["wrist"][over])
            sight.add(over, images, errors[over, :3], np.asarray(seen["tip"], float)[over])
        return {**seen, "error": sight.corrected(errors)}

    return corrected


class LookingPolicy(Skill):
    """The policy with eyes as a skill of the baseline. Without cameras, it works as the one without.

    >>> ramp.run("easy-1", skills=[LookingPolicy()], track="state").counted
    3
    """

    name = "looking-policy"
    serves = "fasten"

    def __init__(self, weights: Array | None = None, eyes: Weights | None = None) -> None:
        self.weights = fasten.load() if weights is None else weights
        self.eyes = localise.load() if eyes is None else eyes

    def work(self, robot: Robot, task: Task) -> str | None:
        """Looks for the hole, and moves the peg until it is seated, as far as the hand tells."""
        held, mass, centre = task.held_pose, task.held_mass, task.held_centre
        if held is None or mass is None or centre is None:
            return "there is no peg in the hand"
        driver = Driver(benchmark(), robot, fasten.SETTINGS, task.width, task.force, False, (held, mass, centre))
        eyes = _Eyes(robot, task, held[:3], Sight(1, self.eyes))
        eyes.expose()
        seen = driver.act(robot, np.zeros(3), 100)
        rest, period = seen.wrench, round(1000 / fasten.RATE)
        features = fasten.Features(1)
        height, before = np.inf, np.inf
        for _ in range(int(fasten.LIMIT * fasten.RATE)):
            eyes.look()
            error = eyes.error(seen.tip_position, seen.tip_quat_wxyz)
            height = -float(error[2])
            if height > localise.OVER:
                eyes.expose()
            pressed = float((rest - seen.wrench)[2]) > PRESSED
            if height < NEARLY and pressed and before - height < RESTING:
                break
            before = height
            error = eyes.sight.corrected(error[None])[0]
            action = fasten.linear(self.weights, features(fasten.row(error, seen, rest, driver)))[0]
            features.action = action[None]
            seen = driver.act(robot, action, period)
        eyes.close()
        return None if height < NEARLY else f"the peg stands {height * 1e3:.1f} mm high after {fasten.LIMIT:.0f} s"


class _Eyes:
    """The wrist camera of a robot at work, whose images come a while after their exposures."""

    def __init__(self, robot: Robot, task: Task, held: Array, sight: Sight) -> None:
        self.robot, self.task, self.held, self.sight = robot, task, held, sight
        self.waiting: list[float] = []

    def expose(self) -> None:
        """Opens the shutters, if there are cameras."""
        try:
            self.robot.expose()
        except Refused:
            return
        self.waiting.append(self.robot.observe().time)

    def look(self, delay: float = 0.1) -> None:
        """Takes in the images of all exposures that are older than ``delay`` s."""
        while self.waiting and self.robot.observe().time - self.waiting[0] > delay - 1e-4:
            self.waiting.pop(0)
            try:
                image = self.robot.look("wrist", size=localise.LOOK)
                # The exposure has an image of each camera, and goes when both were fetched.
                self.robot.look("birds-eye", size=16)
            except Refused:
                return
            error = self.error(image.tip[:3], image.tip[3:])
            if -error[2] > localise.OVER:
                small = localise.shrink(image.pixels)[None]
                self.sight.add(np.array([0]), small, error[None], image.tip[None])

    def close(self) -> None:
        """Fetches what is left, so that nobody takes it for new."""
        self.look(0.0)

    def error(self, position: Array, quat_wxyz: Array) -> Array:
        """The believed way from the peg to its place with the tip at a pose, m."""
        return np.asarray(self.task.goal_pose[:3] - position - fasten.turned(quat_wxyz, self.held))

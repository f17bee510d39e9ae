"""Actions of a policy as commands of the robot, for agents and skills."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ramp._core import Driver as CompiledDriver
from ramp._core import Observation, Robot, benchmark
from ramp.agent import Task


class Driver:
    """Turns the actions of a policy into commands, as the environments do: the same numbers, the same motion.

    A policy acts 5 to 100 times a second, and the robot takes a command every millisecond. In between, the
    target moves evenly. It never leaves the measured tip, or joint, by more than a leash, so that no finite
    number ends the episode by itself.

    >>> class Wave(ramp.Agent):
    ...     def run(self, robot, goal):
    ...         driver = ramp.Driver(robot, "joint", speed=0.5)
    ...         for _ in range(10):
    ...             seen = driver.act(robot, [0.2, 0, 0, 0, 0, 0, 0], periods=50)
    >>> round(ramp.run("easy-1", agent=Wave(), track="state").time.robot, 2)
    0.5
    """

    def __init__(
        self,
        robot: Robot,
        action: str = "cartesian",
        *,
        task: Task | None = None,
        width: float = 0.08,
        force: float = 20.0,
        gripper: bool = False,
        **settings: Any,
    ) -> None:
        """Begins where the arm is.

        Args:
            robot: The robot to be driven.
            action: ``cartesian``: velocity of the target of an impedance, along x, y and z of the world and
                about them; ``joint``: velocity of the target of each joint; ``raw``: joint positions, rad.
            task: For a skill: what is in the hand, whose weight is carried, and what the gripper was told.
            width: What the gripper is told at first without a task: the distance of the fingers, m.
            force: And the force of each finger, N.
            gripper: Whether an action ends with a number for the gripper: -1 to 1, the change of its width in
                0.1 m/s; with ``raw`` the width, m.
            settings: Of the action. ``cartesian``: ``turns`` (true), ``speed`` (0.03 m/s), ``turn_speed``
                (0.3 rad/s), ``leash`` (0.006, 0.006, 0.016 m), ``stiffness`` (three of 1500 N/m, three of
                60 N·m/rad). ``joint``: ``speed`` (0.5 rad/s). ``raw``: ``strict`` (false: an infeasible
                target is approached as fast as the limits allow).

        """
        held = None
        if task is not None:
            width, force = task.width, task.force
            if task.held_pose is not None and task.held_mass is not None and task.held_centre is not None:
                held = (task.held_pose, task.held_mass, task.held_centre)
        self._driver = CompiledDriver(benchmark(), robot, {"action": action, **settings}, width, force, gripper, held)

    def act(self, robot: Robot, action: ArrayLike, periods: int) -> Observation:
        """Lets an action work for ``periods`` control periods of 1 ms; what is sensed after the last.

        ``action``: numbers from -1 to 1, of which 1 is the full speed; those of ``raw`` are rad. With
        ``cartesian``, the shape is (6,), without turns (3,); with ``joint`` and ``raw`` (7,); one more with a
        gripper.

        Raises:
            ramp.Recovered: The arm stopped and is ready again. The next action begins where it stands.

        """
        return self._driver.act(robot, action, periods)

    def lead(self, observation: Observation) -> NDArray[np.float64]:
        """The target from the tip, axes of the world: m, rotation vector in rad, shape (6,).

        Zero without an impedance.
        """
        return self._driver.lead(observation)

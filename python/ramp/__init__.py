"""RAMP, a benchmark of robotic assembly.

A Panda arm builds frames from beams and pins every joint with a peg, in a digital twin. Units are SI: metres,
radians, seconds, newtons. Poses are seven numbers: x, y, z in m, then a quaternion w, x, y, z. The world's
frame is that of the robot's base: x forward, z up, the table's top at z = 0.

>>> import ramp
>>> result = ramp.run("easy-1", track="state")
>>> result.counted
3
"""

from ramp._core import (
    CameraImage,
    Command,
    InputError,
    Observation,
    PlanningError,
    Recovered,
    Refused,
    Robot,
    RobotStopped,
    Snapshot,
    __version__,
    data,
)
from ramp.agent import Agent, EventKind, Motion, Skill, Task
from ramp.bench import Results, bench, run
from ramp.driver import Driver
from ramp.film import Film
from ramp.finder import Absent, Believed, Found, Sight
from ramp.goal import Connection, Goal, goals
from ramp.plan import Plan, plan
from ramp.planner import Problem
from ramp.result import Peg, Result, Time, describe
from ramp.twin import Twin

__all__ = [
    "Absent",
    "Agent",
    "Believed",
    "CameraImage",
    "Command",
    "Connection",
    "Driver",
    "EventKind",
    "Film",
    "Found",
    "Goal",
    "InputError",
    "Observation",
    "Peg",
    "Plan",
    "PlanningError",
    "Problem",
    "Recovered",
    "Refused",
    "Result",
    "Results",
    "Robot",
    "RobotStopped",
    "Motion",
    "Sight",
    "Skill",
    "Snapshot",
    "Task",
    "Time",
    "Twin",
    "__version__",
    "bench",
    "data",
    "describe",
    "goals",
    "plan",
    "run",
]


def _add_environments() -> None:
    """Registers the environments with Gymnasium, where it is installed.

    Gymnasium is optional, so an installation of it that does not work must not stop this package.
    """
    import contextlib

    from ramp._register import register

    with contextlib.suppress(Exception):
        register()


_add_environments()

"""The compiled module."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

__version__: str

class InputError(ValueError):
    """Something that was given is wrong: a name, a file, a number, an array's shape."""

class PlanningError(RuntimeError):
    """There is no plan, or the plan is refused."""

class RobotStopped(RuntimeError):
    """The robot has stopped for good: a limit of the arm, a command that it cannot follow, or the end of its time."""

class Refused(RuntimeError):
    """The robot does not do this, and goes on: the track does not give it, or a camera has stopped."""

class Recovered(RuntimeError):
    """The arm stopped by a reflex or for its speed, stood for a while, and is ready again.

    A new motion begins where it stands.
    """

class Benchmark:
    """Kit, goals, rules and arm of a data folder."""

    def __new__(cls, folder: str) -> Benchmark: ...
    def goal_names(self) -> list[str]: ...
    def open_goal_names(self, set: str) -> list[str]: ...
    def goal(self, name: str) -> str: ...
    def goal_svg(self, name: str) -> str: ...
    def plan(self, goal: str, domain: str | None = None, optimal: bool = False) -> str: ...
    def check_plan(self, goal: str, text: str, domain: str | None = None) -> str: ...
    def pddl(self, goal: str, state: str, domain: str | None = None) -> list[str | None]: ...
    def steps(self, goal: str) -> list[tuple[int, str, str]]: ...
    @staticmethod
    def skills() -> list[str]: ...
    @staticmethod
    def world_names() -> list[str]: ...
    def has_touch(self, world: str) -> bool: ...

class Command:
    """What the arm and the gripper are to do during control periods of 1 ms.

    ``width`` is the wanted distance between the fingers (m, 0 to 0.08), ``force`` the largest force of each finger (N).
    """

    @staticmethod
    def joint_positions(positions: ArrayLike, width: float = 0.04, force: float = 20.0) -> Command:
        """Joint positions, rad, shape (7,); the inner loop tracks them stiffly."""

    @staticmethod
    def joint_velocities(velocities: ArrayLike, width: float = 0.04, force: float = 20.0) -> Command:
        """Joint velocities, rad/s, shape (7,)."""

    @staticmethod
    def joint_torques(torques: ArrayLike, width: float = 0.04, force: float = 20.0) -> Command:
        """Joint torques on top of gravity compensation, N·m, shape (7,)."""

    @staticmethod
    def pose(position: ArrayLike, quat_wxyz: ArrayLike, width: float = 0.04, force: float = 20.0) -> Command:
        """The pose of the tip in the world, tracked stiffly: position in m, quaternion w, x, y, z."""

    @staticmethod
    def impedance(
        position: ArrayLike,
        quat_wxyz: ArrayLike,
        posture: ArrayLike,
        stiffness: ArrayLike | None = None,
        damping_ratio: float = 1.0,
        feed_forward: ArrayLike | None = None,
        width: float = 0.04,
        force: float = 20.0,
    ) -> Command:
        """A spring and damper between the tip and a pose in the world.

        ``stiffness`` is along (N/m) and about (N·m/rad) the axes of the world, ``feed_forward`` a wrench (N, N·m) at
        the tip, ``posture`` joint positions (rad) for the null space.
        """

class Observation:
    """What the robot senses at the end of a control period."""

    @property
    def time(self) -> float:
        """Robot time since the start of the episode, s."""
    @property
    def positions(self) -> NDArray[np.float64]:
        """Joint positions, rad, shape (7,)."""
    @property
    def velocities(self) -> NDArray[np.float64]:
        """Joint velocities, rad/s, shape (7,)."""
    @property
    def torques(self) -> NDArray[np.float64]:
        """Joint torques on top of gravity compensation, N·m, shape (7,)."""
    @property
    def tip_position(self) -> NDArray[np.float64]:
        """Position of the tip in the world, m, shape (3,)."""
    @property
    def tip_quat_wxyz(self) -> NDArray[np.float64]:
        """Rotation of the tip in the world, quaternion w, x, y, z, shape (4,)."""
    @property
    def wrench(self) -> NDArray[np.float64]:
        """Wrench of the hand on the world at the wrist, axes of the world: N, N·m, shape (6,)."""
    @property
    def width(self) -> float:
        """Distance between the two fingers, m."""
    @property
    def gripper_busy(self) -> bool:
        """Whether the gripper is still at what it was commanded last."""
    @property
    def touch_force(self) -> NDArray[np.float64] | None:
        """Force of each finger on the object that it touches, N, axes of the tip, shape (2, 3); ``None`` for fingers
        without tactile sensors."""
    @property
    def touch_centre(self) -> NDArray[np.float64] | None:
        """Centre of pressure of each finger: x and z from the tip, m, shape (2, 2). NaN where the finger presses too
        lightly; ``None`` for fingers without tactile sensors."""

class CameraImage:
    """An image of a camera."""

    @property
    def camera(self) -> str:
        """Name of the camera."""
    @property
    def time(self) -> float:
        """Robot time in the middle of the exposure, s."""
    @property
    def pixels(self) -> NDArray[np.uint8]:
        """Red, green and blue of each pixel, gamma 2.2, shape (800, 1280, 3)."""
    @property
    def depth(self) -> NDArray[np.uint16] | None:
        """On the track ``depth``: the measured distance along the optical axis in each pixel, in 0.1 mm, 0 where there
        is none, shape (800, 1280); ``None`` on other tracks."""
    @property
    def tip(self) -> NDArray[np.float64]:
        """Pose of the tip in the world at that moment, shape (7,)."""

class Robot:
    """A robot to drive. It works until the ``run`` that it was given to is over, on its thread."""

    def step(self, command: Command, periods: int = 1) -> Observation:
        """Lets ``periods`` control periods of 1 ms pass under ``command``; what is sensed after the last."""
    def observe(self) -> Observation:
        """What was sensed last, without letting time pass."""
    def read_parts(self) -> dict[str, NDArray[np.float64]]:
        """Where the parts are, as far as the track tells: name to pose, shape (7,)."""
    def expose(self) -> None:
        """Opens the shutters of both cameras, and takes no time: ``look`` gives the images later, the oldest first."""
    def look(self, camera: str, *, size: int | None = None) -> CameraImage:
        """An image of a camera, ``wrist`` or ``birds-eye``. Robot time passes.

        ``size``: pixels in a row, 16 to 1280, of an image that is drawn in this size at once; without it, 1280.
        """

class Snapshot:
    """The state of a twin, to go back to."""

    @property
    def time(self) -> float:
        """Robot time at which it was taken, s."""

class Twin:
    """The digital twin of an episode."""

    def __new__(
        cls,
        benchmark: Benchmark,
        goal: str,
        track: str = "state",
        world: str = "real",
        start: str = "moved",
        seed: int = 1,
        fault: str | None = None,
    ) -> Twin: ...
    def step(self, command: Command, periods: int = 1) -> Observation: ...
    def observe(self) -> Observation: ...
    def read_parts(self) -> dict[str, NDArray[np.float64]]: ...
    def expose(self) -> None: ...
    def look(self, camera: str, size: int | None = None) -> CameraImage: ...
    def snapshot(self) -> Snapshot: ...
    def restore(self, snapshot: Snapshot) -> None: ...
    def true_poses(self) -> dict[str, NDArray[np.float64]]: ...
    def pegs(self) -> dict[str, str | None]: ...
    def render(self, camera: str = "birds-eye", size: int = 256) -> NDArray[np.uint8]: ...
    @property
    def time(self) -> float: ...
    @property
    def scene(self) -> str: ...
    @property
    def qpos(self) -> NDArray[np.float64]: ...
    @property
    def ctrl(self) -> NDArray[np.float64]: ...
    @property
    def state_hash(self) -> str: ...
    @property
    def largest_force(self) -> float: ...
    @property
    def deepest_penetration(self) -> float: ...

class Driver:
    """Turns actions into commands, as an environment does."""

    def __new__(
        cls,
        benchmark: Benchmark,
        robot: Robot,
        settings: dict[str, Any],
        width: float,
        force: float,
        gripper: bool,
        held: tuple[ArrayLike, float, ArrayLike] | None = None,
    ) -> Driver: ...
    def act(self, robot: Robot, action: ArrayLike, periods: int) -> Observation:
        """Lets an action work for so many control periods of 1 ms; what is sensed after the last."""
    def lead(self, observation: Observation) -> NDArray[np.float64]:
        """The target from the tip, axes of the world: m, rotation vector in rad, shape (6,)."""

class Env:
    """One environment."""

    def __new__(
        cls,
        benchmark: Benchmark,
        skill: str | None,
        goals: Sequence[str],
        *,
        track: str,
        world: str,
        start: str,
        begin: str,
        whole_scene: bool,
        frame: str,
        settings: dict[str, Any],
    ) -> Env: ...
    def prepare(self, threads: int) -> None: ...
    def reset(self, seed: int | None = None) -> None: ...
    def step(self, action: ArrayLike) -> dict[str, Any]: ...
    def observe(self) -> NDArray[np.float32]: ...
    def image(self, view: int) -> NDArray[np.uint8]: ...
    def depth(self, view: int) -> NDArray[np.float32]: ...
    def picture(self) -> NDArray[np.uint8] | None: ...
    def fields(self) -> list[tuple[str, list[int], int, str]]: ...
    def bounds(self) -> list[list[float]]: ...
    def part_names(self) -> list[str]: ...
    @property
    def periods(self) -> int: ...
    def start(self) -> dict[str, Any]: ...
    @property
    def state_hash(self) -> str: ...
    @property
    def scene(self) -> str: ...
    def physics(self) -> list[NDArray[np.float64]]: ...

class EpisodePictures:
    """Pictures for a person of an episode that runs elsewhere."""

    def __new__(cls, benchmark: Benchmark) -> EpisodePictures: ...
    def picture(self) -> NDArray[np.uint8] | None: ...

class Batch:
    """Many environments."""

    def __new__(cls, env: Env, count: int, threads: int) -> Batch: ...
    def reset(self, which: Sequence[int | bool]) -> None: ...
    def step(self, actions: ArrayLike, reset_ended: bool) -> dict[str, Any]: ...
    def starts(self) -> list[dict[str, Any]]: ...
    def end(self, which: Sequence[bool]) -> None: ...
    def observe(self, out: NDArray[np.float32]) -> None: ...
    def images(self, view: int, out: NDArray[np.uint8]) -> None: ...
    def depths(self, view: int, out: NDArray[np.float32]) -> None: ...
    def state_hashes(self) -> list[str]: ...

def run(
    benchmark: Benchmark,
    goal: str,
    *,
    arm: str,
    track: str,
    world: str,
    start: str,
    seed: int,
    task: str = "build",
    state: str | None = None,
    agent: tuple[Any, str, str, Any] | None = None,
    skills: Sequence[tuple[str, str, Any]] = (),
    plan: str | None = None,
    plans: str | None = None,
    planner: tuple[Callable[[str], str], str] | None = None,
    finder: tuple[Callable[[str, bytes, bytes | None], str], str] | None = None,
    domain: str | None = None,
    parameters: str | None = None,
    fault: str | None = None,
    record: str | None = None,
    output: str | None = None,
    repeat: int = 1,
    progress: Callable[[float, int, int], None] | None = None,
    pictures: EpisodePictures | None = None,
) -> str:
    """Runs an episode; the result as JSON."""

def check_event(event: str) -> None:
    """Checks an event that an agent reports, as JSON."""

def describe_event(event: str) -> str:
    """The text of an event, from its JSON."""

def current_result(result: str) -> str:
    """A result as JSON of the present schema, from JSON of this one or of the one before."""

def curve_svg(result: str) -> str:
    """The completion of a result over time, as SVG."""

def log_facts(log: str) -> str:
    """The facts of a log as JSON; its episode does not run again."""

def play_log(
    log: str,
    see: Callable[[dict[str, Any]], None] | None = None,
    *,
    periods: int = 50,
    size: int | None = None,
    depth: bool = False,
) -> str:
    """Runs the episode of a log again; ``see`` gets each sample, with images of ``size`` pixels a side and, with
    ``depth``, their depth in 0.1 mm. What the log says as JSON, with ``equal`` and
    ``differences``."""

def view_lens(benchmark: Benchmark, camera: str, size: int) -> str:
    """The lens and the mounting of a camera's square images, as JSON."""

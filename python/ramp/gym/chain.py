"""A whole goal, in which the environment executes one kind of action and the baseline all others."""

from __future__ import annotations

import os
import queue
import threading
from collections.abc import Sequence
from typing import Any

import gymnasium
import numpy as np
from gymnasium.utils import EzPickle
from numpy.typing import NDArray

from ramp._core import Driver, EpisodePictures, InputError, Robot, benchmark, run_episode
from ramp._core import Observation as Sensed
from ramp.agent import Skill, Task
from ramp.gym.spaces import LIMITS, Goals, as_goals, check_options, check_seed, with_touch
from ramp.gym.window import MODES, Window, check_mode
from ramp.result import Result

Observation = dict[str, NDArray[np.float32]]
Array = NDArray[np.float64]

FIELDS = {
    "positions": 7, "velocities": 7, "torques": 7, "tip": 7, "width": 1, "wrench": 6, "lead": 6,
    "part": 7, "error": 6, "time": 1,
}  # fmt: skip
"""The fields of an observation, as in the environments of single skills, and how many numbers each has."""

TOUCH = {"touch_force": (2, 3), "touch_centre": (2, 2)}
"""Those of tactile sensors, and their shapes."""


class _Closed(Exception):
    """The environment was reset or closed while an episode ran."""


class _Relay(Skill):
    """Connects robot and environment: waits for actions, and returns the observation after each."""

    name = "relay"

    def __init__(self, env: RampChainEnv) -> None:
        self.env = env
        self.serves = env.skill

    def work(self, robot: Robot, task: Task) -> str | None:
        """One action of the plan."""
        env = self.env
        held = None
        if task.held_pose is not None and task.held_mass is not None and task.held_centre is not None:
            held = (task.held_pose, task.held_mass, task.held_centre)
        driver = Driver(benchmark(), robot, env.settings, task.width, task.force, env.gripper, held)
        numbers = env.numbers - 1
        seen = driver.act(robot, np.zeros(numbers), 100)
        begin, tare = seen.time, seen.wrench
        while True:
            left = 1.0 - (seen.time - begin) / env.limit
            env.told.put(_observation(seen, seen.wrench - tare, driver.lead(seen), task, left))
            action = env.actions.get()
            if action is None:
                raise _Closed
            if action[-1] > 0.0:
                return None
            seen = driver.act(robot, action[:-1], env.periods)
            if seen.time - begin >= env.limit:
                return f"it took longer than {env.limit:g} s"


class RampChainEnv(gymnasium.Env[Observation, NDArray[np.float32]], EzPickle):
    """A whole goal: the baseline carries out its plan, except the actions of one kind.

    The physics are continuous: the result of one action is the start of the next. The last number of an
    action ends your action when it is above 0. The reward is the share of counted pegs, at the end of the
    episode.
    """

    metadata: dict[str, Any] = {"render_modes": MODES, "render_fps": 20}

    def __init__(
        self,
        goals: Goals = "easy-1",
        *,
        skill: str = "fasten",
        track: str = "state",
        world: str | os.PathLike[str] = "real",
        start: str | os.PathLike[str] = "moved",
        touch: bool = False,
        turns: bool = False,
        gripper: bool = False,
        speed: float | None = None,
        turn_speed: float | None = None,
        leash: Sequence[float] | None = None,
        stiffness: Sequence[float] | None = None,
        rate: float = 20.0,
        limit: float = 6.0,
        render_mode: str | None = None,
    ) -> None:
        """Makes the environment.

        Args:
            goals: The goal to build: alone, or in a sequence of one.
            skill: The kind of action that is yours, as ``serves`` of :class:`ramp.Skill`.
            track: How parts are observed: ``state``, ``noisy``, ``tags``, ``colour`` or ``depth``.
            world: The physics: ``ideal``, ``real``, ``hard``, or a world file.
            start: Where the parts lie: ``moved``, ``sheet``, ``scattered``, ``jumbled``, or a start file.
            touch: Tactile sensors in the fingers: ``touch_force`` and ``touch_centre`` in observations.
            turns: Whether an action rotates the hand.
            gripper: Whether an action moves the fingers.
            speed: Largest speed of the target, m/s.
            turn_speed: Largest angular speed of the target, rad/s.
            leash: Largest distance of the target from the tip along x, y and z, m.
            stiffness: Stiffness along (N/m) and about (N·m/rad) the axes of the world, six numbers.
            rate: Actions per second, 5 to 100.
            limit: Time limit of one action, s of robot time.
            render_mode: ``rgb_array``: :meth:`render` returns a picture of the work, shape (480, 640, 3);
                ``human``: a window shows it, also while the baseline works; default: no pictures.

        """
        EzPickle.__init__(
            self, goals, skill=skill, track=track, world=world, start=start, touch=touch, turns=turns, gripper=gripper,
            speed=speed, turn_speed=turn_speed, leash=leash, stiffness=stiffness, rate=rate, limit=limit,
            render_mode=render_mode,
        )  # fmt: skip
        if not (5.0 <= rate <= 100.0 and limit > 0.0):
            raise InputError("`rate` is expected within 5 to 100, and `limit` above 0")
        several = as_goals(goals)
        if len(several) != 1:
            raise InputError(f"{len(several)} goals, and one was expected")
        self.goal, self.skill, self.track = several[0], skill, track
        self.world, self.start = with_touch(world, touch), os.fspath(start)
        self.gripper, self.limit = gripper, limit
        check_mode(render_mode)
        self.render_mode = render_mode
        self.metadata = {**type(self).metadata, "render_fps": round(rate)}
        self._window: Window | None = None
        self._pictures: EpisodePictures | None = None
        settings = {
            "action": "cartesian", "turns": turns, "speed": speed, "turn_speed": turn_speed,
            "leash": None if leash is None else list(leash),
            "stiffness": None if stiffness is None else list(stiffness),
        }  # fmt: skip
        self.settings = {key: value for key, value in settings.items() if value is not None}
        self.periods = round(1000.0 / rate)
        self.numbers = (6 if turns else 3) + int(gripper) + 1
        self.action_space = gymnasium.spaces.Box(-1.0, 1.0, (self.numbers,), np.float32)
        shapes = {name: (n,) for name, n in FIELDS.items()} | (TOUCH if benchmark().has_touch(self.world) else {})
        boxes: dict[str, gymnasium.spaces.Space[Any]] = {
            name: gymnasium.spaces.Box(-LIMITS[name], LIMITS[name], shape, np.float32) for name, shape in shapes.items()
        }
        space: Any = gymnasium.spaces.Dict(boxes)
        self.observation_space = space
        self.actions: queue.Queue[Array | None] = queue.Queue(1)
        self.told: queue.Queue[Observation | Result | BaseException] = queue.Queue(1)
        self._thread: threading.Thread | None = None
        self._last = {name: np.zeros(shape, np.float32) for name, shape in shapes.items()}

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observation, dict[str, Any]]:
        """Begins a new episode, and runs the baseline until your first action."""
        check_seed(seed)
        check_options(options)
        super().reset(seed=seed)
        self._abort()
        # An aborted episode may have left items in them.
        self.actions, self.told = queue.Queue(1), queue.Queue(1)
        own = int(self.np_random.integers(2**31))
        self._pictures = None if self.render_mode is None else EpisodePictures(benchmark())
        self._thread = threading.Thread(target=self._build, args=(own,), daemon=True)
        self._thread.start()
        told = self._wait()
        if isinstance(told, Result):
            raise InputError(f"the plan of {told.goal} has no action of the kind {self.skill}")
        if isinstance(told, BaseException):
            self._thread = None
            raise told
        self._last = told
        return told, {"seed": own}

    def _build(self, seed: int) -> None:
        """Runs the whole episode, in a thread of its own."""
        try:
            relay = _Relay(self)
            told: Result | BaseException = Result.from_json(
                run_episode(
                    benchmark(),
                    self.goal.source,
                    arm="panda",
                    track=self.track,
                    world=self.world,
                    start=self.start,
                    seed=seed,
                    skills=[(relay.serves, relay.name, relay)],
                    pictures=self._pictures,
                )
            )
        except BaseException as error:
            told = error
        if not isinstance(told, _Closed):
            self.told.put(told)

    def step(self, action: NDArray[np.float32]) -> tuple[Observation, float, bool, bool, dict[str, Any]]:
        """Applies an action for one period of control; if it ends your action, returns at the next one."""
        if self._thread is None:
            raise gymnasium.error.ResetNeeded("the episode is over, or was not begun: call `reset`")
        numbers = np.asarray(action, dtype=np.float64).ravel()
        if numbers.shape != (self.numbers,) or not np.isfinite(numbers).all():
            raise InputError(f"an action of {self.numbers} finite numbers is expected")
        self.actions.put(np.clip(numbers, -1.0, 1.0))
        told = self._wait()
        if isinstance(told, Result):
            self._thread = None
            info = {"success": told.completion == 1.0, "completion": told.completion, "result": told}
            return self._last, float(told.completion), True, False, info
        if isinstance(told, BaseException):
            self._thread = None
            raise told
        self._last = told
        return told, 0.0, False, False, {"success": False}

    def _wait(self) -> Observation | Result | BaseException:
        """What the episode tells next. Meanwhile the window shows it."""
        if self.render_mode != "human":
            return self.told.get()
        while True:
            try:
                told = self.told.get(timeout=1.0 / self.metadata["render_fps"])
            except queue.Empty:
                self._show()
            else:
                self._show()
                return told

    def render(self) -> Any:
        """A picture of the work, shape (480, 640, 3); with ``human``, it goes to the window."""
        if self.render_mode == "rgb_array":
            picture = None if self._pictures is None else self._pictures.picture()
            if picture is None:
                raise gymnasium.error.ResetNeeded("call `reset` before `render`")
            return picture
        self._show()
        return None

    def _show(self) -> None:
        """Shows a picture in the window, in the mode ``human``."""
        picture = None if self._pictures is None else self._pictures.picture()
        if self.render_mode != "human" or picture is None:
            return
        if self._window is None:
            self._window = Window("RAMP", self.metadata["render_fps"])
        self._window.show(picture)

    def close(self) -> None:
        """Ends the running episode, and closes the window."""
        self._abort()
        if self._window is not None:
            self._window.close()
            self._window = None

    def _abort(self) -> None:
        """Ends the running episode."""
        if self._thread is not None:
            self.actions.put(None)
            self._thread.join()
            self._thread = None


def _observation(seen: Sensed, wrench: Array, lead: Array, task: Task, left: float) -> Observation:
    """Measurements and beliefs, as the fields of an observation."""
    part = _moved(seen, task)
    error = np.concatenate([task.goal_pose[:3] - part[:3], _between(part[3:], task.goal_pose[3:])])
    values = {
        "positions": seen.positions, "velocities": seen.velocities, "torques": seen.torques,
        "tip": np.concatenate([seen.tip_position, seen.tip_quat_wxyz]), "width": [seen.width], "wrench": wrench,
        "lead": lead, "part": part, "error": error, "time": [min(max(left, 0.0), 1.0)],
    }  # fmt: skip
    if seen.touch_force is not None and seen.touch_centre is not None:
        values |= {"touch_force": seen.touch_force, "touch_centre": np.nan_to_num(seen.touch_centre)}
    return {name: np.clip(np.asarray(value, np.float32), -LIMITS[name], LIMITS[name]) for name, value in values.items()}


def _moved(seen: Sensed, task: Task) -> Array:
    """The current pose of the part: a held part moves with the hand."""
    if task.held_pose is None:
        return task.part_pose
    turn = seen.tip_quat_wxyz
    place = seen.tip_position + _product(_product(turn, np.array([0.0, *task.held_pose[:3]])), _inverse(turn))[1:]
    return np.concatenate([place, _product(turn, task.held_pose[3:])])


def _between(first: Array, second: Array) -> Array:
    """The rotation from one quaternion to another as a rotation vector in rad, axes of the world."""
    turn = _product(second, _inverse(first))
    turn = turn if turn[0] >= 0.0 else -turn
    sine = float(np.linalg.norm(turn[1:]))
    angle = 2.0 * np.arctan2(sine, turn[0])
    return np.asarray(turn[1:] * (angle / sine if sine > 1e-12 else 2.0))


def _inverse(turn: Array) -> Array:
    return np.asarray(turn * np.array([1.0, -1.0, -1.0, -1.0]))


def _product(a: Array, b: Array) -> Array:
    vector = a[0] * b[1:] + b[0] * a[1:] + np.cross(a[1:], b[1:])
    return np.array([a[0] * b[0] - a[1:] @ b[1:], *vector])

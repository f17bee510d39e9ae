"""One environment."""

from __future__ import annotations

import copy
import os
from collections.abc import Sequence
from typing import Any

import gymnasium
import numpy as np
from gymnasium.envs.registration import EnvSpec
from gymnasium.utils import EzPickle
from numpy.typing import NDArray

from ramp.gym import spaces
from ramp.gym.window import MODES, Window, check_mode

Observation = dict[str, Any]


class RampEnv(gymnasium.Env[Observation, NDArray[np.float32]], EzPickle):
    """A goal of the benchmark, or one of its skills alone.

    Every argument is also one of ``gymnasium.make``. ``docs/src/reference/environments.md`` describes
    observations, actions and rewards.
    """

    metadata: dict[str, Any] = {"render_modes": MODES, "render_fps": 20}
    _spec: EnvSpec | None = None

    def __init__(
        self,
        skill: str | None = None,
        goals: spaces.Goals = (),
        *,
        track: str = "state",
        world: str | os.PathLike[str] = "real",
        start: str | os.PathLike[str] = "moved",
        begin: str = "ready",
        touch: bool = False,
        starts: tuple[int, int] = (1, 64),
        whole_scene: bool = False,
        frame: str = "rigid",
        action: str = "cartesian",
        turns: bool = True,
        gripper: bool = True,
        strict: bool = False,
        speed: float | None = None,
        turn_speed: float | None = None,
        leash: Sequence[float] | None = None,
        stiffness: Sequence[float] | None = None,
        rate: float = 20.0,
        limit: float = 10.0,
        reward: str = "sparse",
        belief_error: float = 0.0,
        normalise: bool = False,
        truth: bool = False,
        cameras: Sequence[str] = (),
        image_size: int = 84,
        depth: bool = False,
        render_mode: str | None = None,
    ) -> None:
        """Makes the environment.

        Args:
            skill: One of the twelve skills of ``ramp trials``, or ``fasten`` for all joints; default: the
                whole goal.
            goals: Goals whose steps are drawn, or one goal; default for a skill: all nine of the
                benchmark.
            track: How parts are observed: ``state``, ``noisy``, ``tags``, ``colour`` or ``depth``.
            world: The physics: ``ideal``, ``real``, ``hard``, or a world file.
            start: Where the parts lie: ``moved``, ``sheet``, ``scattered``, ``jumbled``, or a start file.
            begin: ``ready`` begins with the skill, ``home`` with the arm at home as in ``ramp trials``.
            touch: Tactile sensors in the fingers: ``touch_force`` and ``touch_centre`` in observations.
            starts: First seed and number of the starts from which episodes are drawn; with a number of 0,
                each episode gets a new one, which takes longer.
            whole_scene: Simulate all parts of the kit instead of those that the task needs.
            frame: How the frame holds that stands before a skill: ``rigid``, as one body without the parts
                that the skill moves, or ``free``, by contact alone. A whole goal is always free.
            action: ``cartesian``, ``joint`` or ``raw``.
            turns: Whether a Cartesian action rotates the hand.
            gripper: Whether an action moves the fingers.
            strict: With ``raw``, an infeasible command ends the episode, as in a judged run.
            speed: Largest speed of the target, m/s, or rad/s of a joint.
            turn_speed: Largest angular speed of the target, rad/s.
            leash: Largest distance of the target from the tip along x, y and z, m.
            stiffness: Stiffness along (N/m) and about (N·m/rad) the axes of the world, six numbers.
            rate: Actions per second, 5 to 100.
            limit: Robot time after which an episode is truncated, s.
            reward: ``sparse`` or ``shaped``.
            belief_error: Standard deviation of an error of the goal pose along x and y, m.
            normalise: Observations in units in which ordinary values are of order one.
            truth: ``info["truth"]`` has the true place of the part of a skill, for labels and training.
            cameras: Images in observations: ``wrist``, ``birds-eye``.
            image_size: Pixels along each side, 16 to 512.
            depth: Depth images as well.
            render_mode: ``rgb_array``: :meth:`render` returns a picture of the work, shape (480, 640, 3);
                ``human``: a window shows it; default: no pictures.

        """
        EzPickle.__init__(
            self, skill, goals, track=track, world=world, start=start, begin=begin, touch=touch, starts=starts,
            whole_scene=whole_scene, frame=frame, action=action, turns=turns, gripper=gripper, strict=strict,
            speed=speed, turn_speed=turn_speed, leash=leash, stiffness=stiffness, rate=rate, limit=limit, reward=reward,
            belief_error=belief_error, normalise=normalise, truth=truth, cameras=cameras, image_size=image_size,
            depth=depth, render_mode=render_mode,
        )  # fmt: skip
        settings: dict[str, Any] = {
            "action": action, "turns": turns, "gripper": gripper, "strict": strict, "speed": speed,
            "turn_speed": turn_speed, "leash": None if leash is None else list(leash),
            "stiffness": None if stiffness is None else list(stiffness), "rate": rate, "limit": limit,
            "reward": reward, "belief_error": belief_error, "truth": truth, "starts": tuple(starts),
        }  # fmt: skip
        check_mode(render_mode)
        self.render_mode = render_mode
        self._window: Window | None = None
        self.cameras = tuple(cameras)
        self.depth = depth
        self.core = spaces.make_core(
            skill, goals, track=track, world=world, start=start, begin=begin, touch=touch,
            whole_scene=whole_scene, frame=frame, cameras=self.cameras,
            image_size=image_size, depth=depth, settings=settings,
        )  # fmt: skip
        self.observation_space = spaces.observation_space(self.core, self.cameras, image_size, depth, normalise)
        self.action_space = spaces.action_space(self.core)
        self.metadata = {**type(self).metadata, "render_fps": round(rate)}
        self._seeded = False
        self._cutter = spaces.Cutter(self.core, normalise)
        self.max_episode_steps = spaces.steps(limit, self.core)
        """Actions after which an episode is truncated."""

    @property
    def spec(self) -> EnvSpec | None:
        """The registered description, with the number of actions after which an episode is truncated."""
        return self._spec

    @spec.setter
    def spec(self, spec: EnvSpec | None) -> None:
        self._spec = spec
        if spec is not None and spec.max_episode_steps is None:
            self._spec = copy.copy(spec)
            self._spec.max_episode_steps = self.max_episode_steps

    def prepare(self, threads: int | None = None) -> None:
        """Makes all starts that episodes are drawn from, by default on all processors."""
        self.core.prepare((os.cpu_count() or 1) if threads is None else threads)

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observation, dict[str, Any]]:
        """Begins a new episode; with a seed, the first one of that seed."""
        spaces.check_seed(seed)
        spaces.check_options(options)
        super().reset(seed=seed)
        if seed is None and not self._seeded:
            seed = int(self.np_random.integers(2**31))
        self._seeded = True
        self.core.reset(seed)
        self._show()
        return self._observe(), self.core.start()

    def step(self, action: NDArray[np.float32]) -> tuple[Observation, float, bool, bool, dict[str, Any]]:
        """Applies an action for one period of control."""
        told = self.core.step(np.asarray(action, dtype=np.float64).ravel())
        reward = float(told.pop("reward"))
        terminated, truncated = bool(told.pop("terminated")), bool(told.pop("truncated"))
        if told["cause"] is None:
            del told["cause"]
        told["is_success"] = told["success"]
        self._show()
        return self._observe(), reward, terminated, truncated, told

    def _observe(self) -> Observation:
        observation: Observation = self._cutter.cut(self.core.observe())
        for view, camera in enumerate(self.cameras):
            observation[camera] = self.core.image(view)
            if self.depth:
                observation[f"{camera}-depth"] = np.minimum(self.core.depth(view), np.float32(10.0))
        return observation

    def render(self) -> Any:
        """A picture of the work, shape (480, 640, 3); with ``human``, it goes to the window."""
        if self.render_mode == "rgb_array":
            picture = self.core.picture()
            if picture is None:
                raise gymnasium.error.ResetNeeded("call `reset` before `render`")
            return picture
        self._show()
        return None

    def _show(self) -> None:
        """Shows a picture in the window, in the mode ``human``."""
        if self.render_mode != "human":
            return
        if self._window is None:
            self._window = Window("RAMP", self.metadata["render_fps"])
        picture = self.core.picture()
        if picture is not None:
            self._window.show(picture)

    def close(self) -> None:
        """Closes the window."""
        if self._window is not None:
            self._window.close()
            self._window = None

"""Many environments at a time, on threads of the compiled module."""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import Any, SupportsIndex

import gymnasium
import numpy as np
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space
from numpy.typing import NDArray

from ramp._core import MAX_SEED, Batch, InputError, integer
from ramp.gym import spaces

Observation = dict[str, Any]
Flags = NDArray[np.bool_]

MAX_ENVS = 4096
"""Largest number of environments at a time."""
MAX_THREADS = 1024
"""Largest number of threads."""


class RampVectorEnv(VectorEnv[Observation, NDArray[np.float32], NDArray[Any]]):
    """Many of :class:`ramp.gym.RampEnv` at a time. A seed gives the same bits for any number of threads."""

    metadata: dict[str, Any] = {"render_modes": [], "autoreset_mode": AutoresetMode.NEXT_STEP}

    def __init__(
        self,
        num_envs: int = 1,
        skill: str | None = None,
        goals: spaces.Goals = (),
        *,
        threads: int | None = None,
        autoreset_mode: AutoresetMode | str = AutoresetMode.NEXT_STEP,
        copy: bool = True,
        max_episode_steps: int | None = None,
        track: str = "state",
        world: str | os.PathLike[str] = "real",
        start: str | os.PathLike[str] = "moved",
        begin: str = "ready",
        touch: bool = False,
        whole_scene: bool = False,
        frame: str = "rigid",
        cameras: Sequence[str] = (),
        image_size: int = 84,
        depth: bool = False,
        normalise: bool = False,
        render_mode: str | None = None,
        **settings: Any,
    ) -> None:
        """Makes the environments.

        Args:
            num_envs: Number of environments.
            skill: As :class:`ramp.gym.RampEnv`, like all arguments that are not described here.
            goals: Likewise.
            threads: Number of threads; default: the number of processors.
            autoreset_mode: ``NEXT_STEP``, ``SAME_STEP`` or ``DISABLED``.
            copy: Return new arrays at each step; otherwise views of buffers that the next step overwrites.
            max_episode_steps: Truncate an episode after this number of actions.
            track: Likewise.
            world: Likewise.
            start: Likewise.
            begin: Likewise.
            touch: Likewise.
            whole_scene: Likewise.
            frame: Likewise.
            cameras: Likewise.
            image_size: Likewise.
            depth: Likewise.
            normalise: Likewise.
            render_mode: ``None``; only a single environment renders.
            settings: All other arguments of a single environment.

        """
        integer("num_envs", num_envs, 1, MAX_ENVS)
        if threads is not None:
            integer("threads", threads, 1, MAX_THREADS)
        if max_episode_steps is not None:
            integer("max_episode_steps", max_episode_steps, 1, MAX_SEED)
        if render_mode is not None:
            raise InputError("many environments are not rendered: render one")
        self.autoreset_mode = _mode(autoreset_mode)
        self.metadata = {**type(self).metadata, "autoreset_mode": self.autoreset_mode}
        settings.setdefault("starts", (1, 64))
        for name in ("starts", "leash", "stiffness"):
            if settings.get(name) is not None:
                settings[name] = tuple(settings[name]) if name == "starts" else list(settings[name])
        self.core = spaces.make_core(
            skill, goals, track=track, world=world, start=start, begin=begin, touch=touch,
            whole_scene=whole_scene, frame=frame, cameras=cameras,
            image_size=image_size, depth=depth, settings=settings,
        )  # fmt: skip
        self.num_envs = num_envs
        self.render_mode = None
        self.copy = copy
        self.cameras = tuple(cameras)
        self.depth = depth
        self.limit = max_episode_steps
        self.single_observation_space = spaces.observation_space(self.core, cameras, image_size, depth, normalise)
        self.single_action_space = spaces.action_space(self.core)
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self.action_space = batch_space(self.single_action_space, num_envs)
        self.threads = threads or os.cpu_count() or 1
        self.batch = Batch(self.core, num_envs, self.threads)
        width = self.core.observe().shape[0]
        self._rows = np.zeros((num_envs, width), np.float32)
        size = num_envs * image_size * image_size
        self._images = {camera: np.zeros(size * 3, np.uint8) for camera in cameras}
        self._depths = {camera: np.zeros(size, np.float32) for camera in cameras if depth}
        self._size = image_size
        self._steps = np.zeros(num_envs, np.int64)
        self._seeded = False
        self._cutter = spaces.Cutter(self.core, normalise)
        limit = settings.get("limit", 10.0)
        self.max_episode_steps = max_episode_steps or spaces.steps(limit, self.core)
        """Actions after which an episode is truncated."""

    def prepare(self) -> None:
        """Makes all starts that episodes are drawn from, on all threads. Later resets are fast."""
        self.core.prepare(self.threads)

    def reset(
        self, *, seed: int | list[int | None] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observation, dict[str, Any]]:
        """Begins new episodes: environment ``i`` with ``seed + i``, or with its own of a list.

        ``options={"reset_mask": flags}`` resets only the environments whose flag is set.
        """
        spaces.check_options(options, ["reset_mask"])
        if isinstance(seed, SupportsIndex):
            seed = integer("seed", seed, 0, MAX_SEED - self.num_envs + 1)
        super().reset(seed=seed if isinstance(seed, int) else None)
        if seed is None and not self._seeded:
            seed = int(self.np_random.integers(2**31))
        self._seeded = True
        mask = (options or {}).get("reset_mask")
        chosen = np.ones(self.num_envs, bool) if mask is None else np.asarray(mask, bool)
        if chosen.shape != (self.num_envs,):
            raise InputError(f"reset_mask has the shape {chosen.shape}, and ({self.num_envs},) was expected")
        if isinstance(seed, int):
            seeds: list[int | None] = [seed + index for index in range(self.num_envs)]
        else:
            seeds = list(seed) if seed is not None else [None] * self.num_envs
        if len(seeds) != self.num_envs:
            raise InputError(f"{len(seeds)} seeds, and {self.num_envs} were expected")
        for each in seeds:
            spaces.check_seed(each)
        which: list[int | bool] = [
            (True if seed is None else int(seed)) if wanted else False
            for seed, wanted in zip(seeds, chosen, strict=True)
        ]
        self.batch.reset(which)
        self._steps[chosen] = 0
        return self._observe(), self._starts(chosen)

    def _starts(self, chosen: Flags) -> dict[str, Any]:
        """What is known at the start of the chosen environments."""
        infos: dict[str, Any] = {}
        for index, start in enumerate(self.batch.starts()):
            if chosen[index]:
                infos = self._add_info(infos, start, index)
        return infos

    def step(
        self, actions: NDArray[np.float32]
    ) -> tuple[Observation, NDArray[np.float64], Flags, Flags, dict[str, Any]]:
        """Applies one action per environment for one period of control."""
        resets = self.autoreset_mode is AutoresetMode.NEXT_STEP
        told = self.batch.step(np.asarray(actions, dtype=np.float64).ravel(), resets)
        reset: Flags = told.pop("reset")
        self._steps += 1
        self._steps[reset] = 0
        reward, terminated, truncated = told.pop("reward"), told.pop("terminated"), told.pop("truncated")
        if self.limit is not None:
            late = (self._steps >= self.limit) & ~terminated
            truncated |= late
            if resets and late.any():
                self.batch.end(late.tolist())
        causes = told.pop("cause")
        infos: dict[str, Any] = {}
        stepped = ~reset
        off = told.pop("off", None)
        told["is_success"] = told["success"]
        for name, values in told.items():
            infos[name], infos[f"_{name}"] = values, stepped
        if off is not None:
            infos["truth"], infos["_truth"] = {"off": off, "_off": stepped}, stepped
        if any(cause is not None for cause in causes):
            infos["cause"] = np.array(causes, dtype=object)
            infos["_cause"] = np.array([cause is not None for cause in causes])
        if self.autoreset_mode is AutoresetMode.SAME_STEP and (terminated | truncated).any():
            return self._begin_again(terminated | truncated, infos), reward, terminated, truncated, infos
        return self._observe(), reward, terminated, truncated, infos

    def _begin_again(self, ended: Flags, infos: dict[str, Any]) -> Observation:
        """Resets the environments that ended; their last observations and infos go into ``infos``."""
        last = self._observe()
        final = np.full(self.num_envs, None, dtype=object)
        for index in np.flatnonzero(ended):
            final[index] = {name: values[index].copy() for name, values in last.items()}
        told = {name: values for name, values in infos.items() if not name.startswith("_")}
        infos["final_info"] = {**told, **{f"_{name}": ended for name in told}}
        infos["final_obs"], infos["_final_obs"], infos["_final_info"] = final, ended, ended
        self.batch.reset(ended.tolist())
        self._steps[ended] = 0
        infos.update(self._starts(ended))
        return self._observe()

    def _observe(self) -> Observation:
        self.batch.observe(self._rows)
        rows = self._rows.copy() if self.copy else self._rows
        observation: Observation = self._cutter.cut(rows)
        for view, camera in enumerate(self.cameras):
            flat = self._images[camera]
            self.batch.images(view, flat)
            images = flat.reshape(self.num_envs, self._size, self._size, 3)
            observation[camera] = images.copy() if self.copy else images
            if self.depth:
                depths = self._depths[camera]
                self.batch.depths(view, depths)
                shaped = np.minimum(depths.reshape(self.num_envs, self._size, self._size), np.float32(10.0))
                observation[f"{camera}-depth"] = shaped
        return observation


def _mode(mode: AutoresetMode | str) -> AutoresetMode:
    name = str(mode).upper().removeprefix("AUTORESETMODE.")
    if not isinstance(mode, AutoresetMode) and name not in AutoresetMode.__members__:
        raise InputError(f"there is no autoreset mode {mode!r}; there are {', '.join(AutoresetMode.__members__)}")
    return mode if isinstance(mode, AutoresetMode) else AutoresetMode[name]


def make_vec(env_id: str, num_envs: int, **arguments: Any) -> gymnasium.vector.VectorEnv[Any, Any, Any]:
    """Short for ``gymnasium.make_vec``."""
    return gymnasium.make_vec(env_id, num_envs=num_envs, **arguments)

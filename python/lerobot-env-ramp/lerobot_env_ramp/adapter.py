"""An environment of RAMP with the names that LeRobot expects. It needs no LeRobot."""

from __future__ import annotations

from typing import Any

import gymnasium
import numpy as np

from ramp._register import GOALS, SKILLS
from ramp.demos.episode import CAMERAS
from ramp.demos.logs import FIELDS

ACTION_OF_FASTEN = {"speed": 0.03, "leash": (0.005, 0.005, 0.016)}
"""How actions of ``fasten`` move the hand in the demonstrations."""


def environment(task: str) -> tuple[str, dict[str, Any]]:
    """The id of a skill's or a goal's environment, and the arguments with which `ramp demos` records it."""
    for name, skill in SKILLS.items():
        if task == skill:
            return f"RAMP/{name}-v0", dict(ACTION_OF_FASTEN) if skill.startswith("fasten") else {}
    for name, goal in GOALS.items():
        if task == goal:
            return f"RAMP/{name}-v0", {"action": "raw"}
    known = ", ".join((*SKILLS.values(), *GOALS.values()))
    raise ValueError(f"there is no task {task!r} in RAMP; there are {known}")


def state_fields(task: str, env: Any) -> list[str]:
    """The fields of an observation that make the state, as in the data sets of `ramp demos`."""
    if task in GOALS.values():
        return list(FIELDS)
    return [name for name, _, _, _ in env.core.fields()]


def steps_of(env: Any) -> int:
    """Actions after which an episode of an environment of RAMP is truncated."""
    steps: int = env.unwrapped.max_episode_steps
    return steps


class Adapter(gymnasium.Wrapper[Any, Any, Any, Any]):
    """One environment: observations ``agent_pos`` and ``pixels``, ``task_description``, ``is_success``."""

    def __init__(self, task: str, **arguments: Any) -> None:
        """The environment of a task; ``arguments`` are those of RAMP's environments."""
        import ramp  # noqa: F401, registers the environments

        name, own = environment(task)
        self.task = task
        env = gymnasium.make(
            name, disable_env_checker=True, cameras=tuple(CAMERAS), render_mode="rgb_array", **{**own, **arguments}
        ).unwrapped
        super().__init__(env)
        space: Any = env.observation_space
        self.names = state_fields(task, env)
        count = sum(int(np.prod(space[name].shape)) for name in self.names)
        pixels = {key: space[camera] for camera, key in CAMERAS.items()}
        self.observation_space = gymnasium.spaces.Dict(
            {
                "agent_pos": gymnasium.spaces.Box(-np.inf, np.inf, (count,), np.float32),
                "pixels": gymnasium.spaces.Dict(pixels),
            }
        )
        self._max_episode_steps = steps_of(env)
        self.task_description = task

    def _turned(self, seen: dict[str, Any]) -> dict[str, Any]:
        state = np.concatenate([seen[name].ravel() for name in self.names])
        return {"agent_pos": state, "pixels": {key: seen[camera] for camera, key in CAMERAS.items()}}

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Any, dict[str, Any]]:
        """Begins a new episode; ``task_description`` is then its instruction."""
        seen, info = self.env.reset(seed=seed)
        self.task_description = str(info.get("action") or f"build the frame {self.task}")
        return self._turned(seen), {**info, "is_success": False}

    def step(self, action: Any) -> tuple[Any, Any, bool, bool, dict[str, Any]]:
        """Applies an action."""
        seen, reward, terminated, truncated, info = self.env.step(action)
        return self._turned(seen), reward, terminated, truncated, info

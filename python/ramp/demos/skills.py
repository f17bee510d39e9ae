"""Demonstrations of a skill: a policy works in the skill's environment."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ramp._core import InputError, benchmark
from ramp._register import SKILLS, problem
from ramp.demos.episode import CAMERAS, DEPTH_UNIT, Description, Episode
from ramp.policies import fasten

STARTS = (1, 0)
"""Each seed of an episode has a start of its own."""

ACTIONS = ("x", "y", "z")
"""Numbers of an action: the velocity of the target along the axes of the world, as shares of the largest."""


def demonstrated() -> list[str]:
    """The skills for which there is a policy."""
    return [skill for skill in SKILLS.values() if skill.startswith("fasten")]


class SkillRecorder:
    """Records episodes of a skill, by the policy that comes with the package."""

    def __init__(
        self,
        skill: str,
        *,
        goals: list[str],
        world: str,
        start: str,
        track: str,
        belief_error: float,
        size: int,
        depth: bool,
    ) -> None:
        """Makes the environment; the arguments are those of the environments."""
        if (wrong := problem()) is not None:
            raise InputError(wrong)
        if skill not in demonstrated():
            can = ", ".join(demonstrated())
            raise InputError(f"there is no policy that demonstrates `{skill}`; there is one for {can}")
        self.arguments: dict[str, Any] = {
            "goals": goals, "world": world, "start": start, "track": track, "belief_error": belief_error,
            "rate": fasten.RATE, "starts": list(STARTS), **fasten.SETTINGS,
        }  # fmt: skip
        name = next(name for name, value in SKILLS.items() if value == skill)
        self.id = f"RAMP/{name}-v0"
        views = {"cameras": list(CAMERAS), "image_size": size, "depth": depth} if size else {}
        self.env = make(self.id, self.arguments | views)
        fields = {name: int(np.prod(shape)) for name, shape, _, _ in self.env.core.fields()}
        source = {"kind": "skill", "environment": self.id, "arguments": self.arguments, "policy": "fasten.npy"}
        self.description = Description(round(fasten.RATE), fields, ACTIONS, size, depth, source)
        self.weights = fasten.load()

    def record(self, seed: int) -> Episode:
        """The episode of a seed."""
        seen, told = self.env.reset(seed=seed)
        features = fasten.Features(1)
        rows, actions, rewards = [seen], [], []
        over = success = False
        while not over:
            row = {key: seen[key][None] for key in ("error", "tip", "wrench", "lead")}
            action = fasten.linear(self.weights, features(row))[0].astype(np.float32)
            features.action = action[None].astype(float)
            seen, reward, terminated, truncated, info = self.env.step(action)
            over, success = terminated or truncated, bool(info["success"])
            rows.append(seen)
            actions.append(action)
            rewards.append(reward)
        facts = {
            "seed": seed,
            "task": str(told["action"]),
            "success": success,
            "goal": told["goal"],
            "part": told["part"],
            "scene_seed": told["scene_seed"],
            "state": self.env.core.state_hash,
        }
        fields = {key: np.stack([row[key].ravel() for row in rows]) for key in self.description.fields}
        images = {key: np.stack([row[it] for row in rows]) for it, key in self.description.cameras().items()}
        deep = self.description.deep()
        depths = {key: np.stack([units(row[f"{it}-depth"]) for row in rows]) for it, key in deep.items()}
        return Episode(fields, images, depths, np.stack(actions), np.asarray(rewards, np.float32), facts)


def units(distances: NDArray[np.float32]) -> NDArray[np.uint16]:
    """A depth image of an environment, m, as one of a data set: 0 for what it cannot hold."""
    counts = np.round(distances / DEPTH_UNIT)
    return np.where(counts <= np.iinfo(np.uint16).max, counts, 0).astype(np.uint16)[..., None]


def make(environment: str, arguments: dict[str, Any]) -> Any:
    """An environment of this package, by its id and the arguments of a data set."""
    import gymnasium

    import ramp  # noqa: F401, registers the environments

    known = {f"RAMP/{name}-v0" for name in SKILLS}
    if environment not in known:
        raise InputError(f"there is no environment {environment!r} of a skill")
    given: dict[str, Any] = {key: tuple(value) if key == "starts" else value for key, value in arguments.items()}
    try:
        return gymnasium.make(environment, disable_env_checker=True, **given).unwrapped
    except TypeError as error:
        raise InputError(f"the arguments of {environment} are wrong: {error}") from None


def lenses(size: int) -> dict[str, Any]:
    """The lens and the mounting of each camera, by its key."""
    import json

    from ramp._core import view_lens

    return {key: json.loads(view_lens(benchmark(), camera, size)) for camera, key in CAMERAS.items()}

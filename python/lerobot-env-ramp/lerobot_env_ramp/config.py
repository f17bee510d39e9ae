"""The options of `lerobot-eval --env.type=ramp`."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import gymnasium
from lerobot.configs.types import FeatureType, PolicyFeature
from lerobot.envs.configs import EnvConfig

from lerobot_env_ramp.adapter import Adapter


@EnvConfig.register_subclass("ramp")
@dataclass
class RampEnvConfig(EnvConfig):
    """Skills and goals of RAMP. All but ``task`` are arguments of its environments."""

    task: str = "fasten"
    """A skill or a goal, or several with commas between them."""
    fps: int = 20
    goals: str = ""
    """Goals from which a skill's steps are drawn, with commas between them; empty: all nine."""
    world: str = "real"
    start: str = "moved"
    track: str = "noisy"
    belief_error: float = 0.0
    image_size: int = 96
    first_start: int = 1
    starts: int = 0
    """Number of starts that episodes are drawn from; 0: each seed has its own."""
    features: dict[str, PolicyFeature] = field(default_factory=dict)
    features_map: dict[str, str] = field(
        default_factory=lambda: {
            "action": "action",
            "agent_pos": "observation.state",
            "pixels/wrist": "observation.images.wrist",
            "pixels/birds_eye": "observation.images.birds_eye",
        }
    )

    def __post_init__(self) -> None:
        """Takes the shapes of the first task's environment."""
        env = self._one(self.tasks()[0])
        space = env.observation_space
        image = PolicyFeature(FeatureType.VISUAL, (self.image_size, self.image_size, 3))
        self.features = {
            "action": PolicyFeature(FeatureType.ACTION, env.action_space.shape),
            "agent_pos": PolicyFeature(FeatureType.STATE, space["agent_pos"].shape),
            "pixels/wrist": image,
            "pixels/birds_eye": image,
        }
        env.close()

    def tasks(self) -> list[str]:
        """The tasks."""
        return [name.strip() for name in self.task.split(",")]

    def _one(self, task: str) -> Adapter:
        """One environment of a task."""
        arguments: dict[str, Any] = {
            "world": self.world, "start": self.start, "track": self.track, "rate": float(self.fps),
            "image_size": self.image_size, "starts": (self.first_start, self.starts),
        }  # fmt: skip
        if self.goals:
            arguments["goals"] = [name.strip() for name in self.goals.split(",")]
        if self.belief_error:
            arguments["belief_error"] = self.belief_error
        return Adapter(task, **arguments)

    @property
    def gym_kwargs(self) -> dict[str, Any]:
        """Nothing: :meth:`create_envs` makes the environments."""
        return {}

    def create_envs(self, n_envs: int, use_async_envs: bool = False) -> dict[str, dict[int, Any]]:
        """Environments of each task, ``n_envs`` at a time."""
        kind = gymnasium.vector.AsyncVectorEnv if use_async_envs else gymnasium.vector.SyncVectorEnv
        mode = gymnasium.vector.AutoresetMode.SAME_STEP
        suites = {}
        for number, task in enumerate(self.tasks()):
            makers = [lambda task=task: self._one(task)] * n_envs
            suites[number] = kind(makers, autoreset_mode=mode)
        return {"ramp": suites}

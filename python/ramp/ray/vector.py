"""Environments in actors of Ray: one vector of environments, on more than one machine."""

from __future__ import annotations

import operator
from collections.abc import Sequence
from typing import Any, SupportsIndex

import gymnasium
import numpy as np
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space
from numpy.typing import NDArray

from ramp._core import MAX_SEED, InputError, integer
from ramp.ray.engine import build, refusal

MAX_ACTORS = 1024
"""Largest number of actors."""


class Actor:
    """Holds a part of the environments on a worker."""

    def __init__(self, driver: str, env_id: str, num_envs: int, arguments: dict[str, Any]) -> None:
        """Makes ``num_envs`` environments of an id."""
        import ramp  # noqa: F401  registers the environments

        refused = refusal(driver)
        if refused is not None:
            raise InputError(refused)
        self.envs: Any = gymnasium.make_vec(env_id, num_envs=num_envs, **arguments)

    def describe(self) -> tuple[Any, Any, Any]:
        """Space of observations, space of actions, and metadata, of a single environment."""
        return self.envs.single_observation_space, self.envs.single_action_space, self.envs.metadata

    def reset(self, seeds: list[int | None], options: dict[str, Any] | None) -> Any:
        """Resets the environments, each with a seed or going on."""
        return self.envs.reset(seed=seeds, options=options)

    def step(self, actions: NDArray[np.float32]) -> Any:
        """Applies one action per environment."""
        return self.envs.step(actions)


class RayVectorEnv(VectorEnv[Any, NDArray[np.float32], NDArray[Any]]):
    """Many environments, an equal part in each of several actors. Each actor takes one processor.

    With a seed, observations, rewards and flags equal those of ``gymnasium.make_vec`` with these arguments.
    The cluster is the one to which this process is connected (``ray.init``), or a new one on this machine. An
    actor that is lost is an error of the engine: the state of its environments is gone.
    """

    metadata: dict[str, Any] = {"render_modes": [], "autoreset_mode": AutoresetMode.NEXT_STEP}

    def __init__(self, env_id: str, num_envs: int, *, actors: int, **arguments: Any) -> None:
        """Starts the actors, and makes their environments.

        Args:
            env_id: An environment's id, such as ``RAMP/Fasten-v0``.
            num_envs: Number of environments, a multiple of ``actors``.
            actors: Number of actors.
            arguments: As for ``gymnasium.make_vec``. Files that they name have to be on all nodes.

        """
        try:
            import ray
        except ImportError:
            raise InputError("environments in actors need Ray: pip install 'ramp-benchmark[ray]'") from None
        integer("actors", actors, 1, MAX_ACTORS)
        integer("num_envs", num_envs, 1, MAX_SEED)
        if num_envs % actors:
            raise InputError(f"{num_envs} environments are no multiple of {actors} actors")
        self.num_envs = num_envs
        self.render_mode = None
        self._ray = ray
        self._share = num_envs // actors
        if "vectorization_mode" not in arguments:
            arguments = {"threads": 1, **arguments}
        remote = ray.remote(num_cpus=1)(Actor)
        self._actors = [remote.remote(build(), env_id, self._share, arguments) for _ in range(actors)]
        try:
            single_observation, single_action, metadata = ray.get(self._actors[0].describe.remote())
        except ray.exceptions.RayError as error:
            self.close_extras()
            raise InputError(f"an actor cannot make its environments: {error}") from None
        self.metadata = metadata
        self.single_observation_space, self.single_action_space = single_observation, single_action
        self.observation_space = batch_space(single_observation, num_envs)
        self.action_space = batch_space(single_action, num_envs)
        self._seeded = False

    def reset(
        self, *, seed: int | Sequence[int | None] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Any, dict[str, Any]]:
        """Begins new episodes: environment ``i`` with ``seed + i``, or with its own of a list.

        ``options={"reset_mask": flags}`` resets only the environments whose flag is set.
        """
        if isinstance(seed, SupportsIndex):
            seed = integer("seed", operator.index(seed), 0, MAX_SEED - self.num_envs + 1)
        super().reset(seed=seed if isinstance(seed, int) else None)
        if seed is None and not self._seeded:
            seed = int(self.np_random.integers(2**31))
        self._seeded = True
        if isinstance(seed, int):
            seeds: list[int | None] = [seed + index for index in range(self.num_envs)]
        else:
            seeds = list(seed) if seed is not None else [None] * self.num_envs
        if len(seeds) != self.num_envs:
            raise InputError(f"{len(seeds)} seeds, and {self.num_envs} were expected")
        mask = (options or {}).get("reset_mask")
        flags = None if mask is None else np.asarray(mask, bool)
        if flags is not None and flags.shape != (self.num_envs,):
            raise InputError(f"reset_mask has the shape {flags.shape}, and ({self.num_envs},) was expected")
        calls = []
        for actor, part in zip(self._actors, self._parts(), strict=True):
            its = options if flags is None else {**(options or {}), "reset_mask": flags[part]}
            calls.append(actor.reset.remote(seeds[part], its))
        told = self._ray.get(calls)
        observations, infos = zip(*told, strict=True)
        return _join(observations), self._join_infos(infos)

    def step(
        self, actions: NDArray[np.float32]
    ) -> tuple[Any, NDArray[Any], NDArray[Any], NDArray[Any], dict[str, Any]]:
        """Applies one action per environment for one period of control."""
        actions = np.asarray(actions)
        if actions.shape != self.action_space.shape:
            raise InputError(f"actions have the shape {actions.shape}, and {self.action_space.shape} was expected")
        told = self._ray.get(
            [actor.step.remote(actions[part]) for actor, part in zip(self._actors, self._parts(), strict=True)]
        )
        observations, rewards, terminated, truncated, infos = zip(*told, strict=True)
        ends = np.concatenate(terminated), np.concatenate(truncated)
        return _join(observations), np.concatenate(rewards), *ends, self._join_infos(infos)

    def close_extras(self, **_: Any) -> None:
        """Ends the actors."""
        for actor in self._actors:
            self._ray.kill(actor)

    def _parts(self) -> list[slice]:
        """The environments of each actor."""
        return [slice(first, first + self._share) for first in range(0, self.num_envs, self._share)]

    def _join_infos(self, infos: Sequence[dict[str, Any]]) -> dict[str, Any]:
        """The infos of all actors as one. What an actor does not tell is zero, false or None."""
        joined: dict[str, Any] = {}
        for name in dict.fromkeys(name for told in infos for name in told):
            found = [told.get(name) for told in infos]
            known = next(it for it in found if it is not None)
            if isinstance(known, dict):
                joined[name] = self._join_infos([it or {} for it in found])
                continue
            nothing = np.full(known.shape, None) if known.dtype == object else np.zeros_like(known)
            joined[name] = np.concatenate([nothing if it is None else it for it in found])
        return joined


def _join(observations: Sequence[dict[str, NDArray[Any]]]) -> dict[str, NDArray[Any]]:
    """The observations of all actors as one."""
    return {name: np.concatenate([told[name] for told in observations]) for name in observations[0]}

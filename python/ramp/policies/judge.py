"""Judges policies for `fasten` on held starts, beside rivals with and without a search.

python -m ramp.policies.judge weights.npy

That takes an hour or more of CPU time for each world and error: steps are slow where the peg touches a large
frame.
"""

from __future__ import annotations

import argparse
import dataclasses
import math
from collections.abc import Callable
from typing import Any

import numpy as np

from ramp.policies.fasten import (
    RATE,
    SETTINGS,
    STIFFNESS,
    WEIGHTS,
    Array,
    Policy,
    environments,
    episodes,
    linear,
    load,
)


def push(features: Array) -> Array:
    """The rival without a search: over the hole as it is believed, and straight down."""
    sideways = np.clip(2.0 * features[:, :2], -1.0, 1.0)
    return np.concatenate([sideways, -np.ones((len(features), 1))], axis=1)


@dataclasses.dataclass(frozen=True)
class Spiral:
    """The rival with a search: over the hole, down to the plate, then a growing spiral with light force."""

    pitch: float
    """Distance between turns, m."""
    speed: float
    """Along the spiral, m/s."""
    force: float
    """Of the spring on the plate, N."""

    def policy(self) -> Policy:
        """As a policy, for any number of environments; it begins anew when all are over the plate again."""
        turns: list[Array] = []

        def act(features: Array) -> Array:
            if not turns or features[:, 2].min() > 0.9:
                turns[:] = [np.zeros(len(features))]
            return self._step(features, turns[0])

        return act

    def _step(self, features: Array, turn: Array) -> Array:
        touching = (features[:, 2] < 0.03) & (features[:, 2] > -0.2)
        radius = self.pitch * turn / (2.0 * np.pi)
        turn[touching] += self.speed / RATE / np.maximum(radius[touching], 5e-4)
        radius = self.pitch * turn / (2.0 * np.pi) / 3e-3
        want = features[:, :2] + (radius * np.stack([np.cos(turn), np.sin(turn)])).T
        lead = -self.force / STIFFNESS / SETTINGS["leash"][2]
        down = np.where(touching, np.clip(5.0 * (lead - features[:, 17]), -1.0, 1.0), -1.0)
        return np.concatenate([np.clip(2.0 * want, -1.0, 1.0), down[:, None]], axis=1)


LIGHT = Spiral(1.6e-3, 0.03, 4.0)
"""With the numbers of the baseline's search (``peg_search``)."""
HEAVY = Spiral(0.7e-3, 8.0e-3, 9.0)
"""Slower, finer and pressed harder: friction holds the tip until the hand is 1.8 mm ahead of it."""


def judge(env: Any, policy: Policy, count: int = 200) -> tuple[int, float]:
    """How many of ``count`` episodes succeed, and the median time of those, s."""
    won, times = 0, []
    for first in range(0, count, env.num_envs):
        _, success, time_of = episodes(env, [500_000 + first + it for it in range(env.num_envs)], policy)
        won += int(success.sum())
        times += time_of[success].tolist()
    return won, float(np.median(times)) if times else float("nan")


def interval(won: int, count: int) -> tuple[float, float]:
    """Wilson's interval of 95 % for a share, in %."""
    share, z = won / count, 1.96
    middle = (share + z**2 / (2 * count)) / (1 + z**2 / count)
    half = z * math.sqrt(share * (1 - share) / count + z**2 / (4 * count**2)) / (1 + z**2 / count)
    return 100.0 * (middle - half), 100.0 * (middle + half)


def main() -> None:
    """Judges, as the command line says."""
    parser = argparse.ArgumentParser(description="Judges a policy for `fasten` on held starts.")
    parser.add_argument("weights", nargs="?", default=str(WEIGHTS))
    parser.add_argument("--worlds", default="ideal,real")
    parser.add_argument("--errors", default="0,1,2", help="errors of the hole's place to judge at, mm")
    parser.add_argument("--episodes", type=int, default=200, help="held starts to judge on")
    told = parser.parse_args()
    weights = load(told.weights)
    rivals: dict[str, Callable[[], Policy]] = {
        "linear policy": lambda: lambda features: linear(weights, features),
        "light spiral": LIGHT.policy,
        "heavy spiral": HEAVY.policy,
        "straight push": lambda: push,
    }
    for world in told.worlds.split(","):
        for error in told.errors.split(","):
            env = environments(world, 20, (100_001, told.episodes), 1e-3 * float(error), frame="free")
            for name, rival in rivals.items():
                won, median = judge(env, rival(), told.episodes)
                low, high = interval(won, told.episodes)
                share = f"{won} of {told.episodes}, {low:.1f} to {high:.1f} %"
                print(f"{world}  {error} mm  {name:13}  {share}  {median:.2f} s", flush=True)


if __name__ == "__main__":
    main()

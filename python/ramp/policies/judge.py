"""Judges policies for `fasten` on held starts, beside rivals with and without a search, and with eyes.

    python -m ramp.policies.judge weights.npy
    python -m ramp.policies.judge --goals easy-3,medium-2,hard-2 --errors 0,2,4,6,8 --table curve.csv

That takes an hour or more of CPU time for each world and error: steps are slow where the peg touches a large
frame.

An environment begins with the hand over the hole, so a policy need not see where it is. With ``--misled`` the
hand goes over the believed hole first.
"""

from __future__ import annotations

import argparse
import dataclasses
import math
from collections.abc import Callable
from typing import Any

import numpy as np

from ramp._core import InputError
from ramp.policies import clone
from ramp.policies.clone import Clone
from ramp.policies.convolution import Weights
from ramp.policies.fasten import (
    RATE,
    SETTINGS,
    STIFFNESS,
    WEIGHTS,
    Aim,
    Array,
    Policy,
    Rows,
    environments,
    episodes,
    linear,
    load,
)
from ramp.policies.localise import IMAGE
from ramp.policies.looking import aim


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


def mistaken(error: float, count: int, seed: int) -> Aim:
    """Holes believed off by ``error`` (m, 1 σ along x and y, a fifth of it along z) through an episode."""
    off = np.random.default_rng(seed).normal(0.0, error, (count, 3)) * (1.0, 1.0, 0.2)

    def believed(seen: Rows) -> Rows:
        errors = np.asarray(seen["error"], float)
        errors[:, :3] += off
        return {**seen, "error": errors}

    return believed


Rival = Callable[[int], tuple[Policy, Aim | None]]
"""Makes what works in that many environments: a policy, and what changes observations before it sees them."""


def judge(env: Any, rival: Rival, error: float, count: int = 200) -> tuple[int, float]:
    """Successes in ``count`` episodes with holes believed off by ``error`` (m), and their median time, s."""
    won, times, at_once = 0, [], env.num_envs
    for first in range(FIRST_SEED, FIRST_SEED + count, at_once):
        believed, seeds = mistaken(error, at_once, first), [first + index for index in range(at_once)]
        policy, then = rival(at_once)
        _, success, time_of = episodes(env, seeds, policy, believed if then is None else _both(believed, then))
        won += int(success.sum())
        times += time_of[success].tolist()
    return won, float(np.median(times)) if times else float("nan")


def _both(first: Aim, then: Aim) -> Aim:
    return lambda seen: then(first(seen))


LOOKING, CLONED, GREY = "with images", "cloned policy", "cloned without images"
SEEING = (LOOKING, CLONED, GREY)
"""The policies that need images."""
GREYNESS = 102
"""Of the images that tell nothing: the mean of what the networks expect."""


def rivals(weights: Array, cloned: Weights) -> dict[str, Rival]:
    """The policies by name, with the weights of the linear policy and of the cloned one.

    The cloned one with grey images tells what the images are worth to it.
    """

    def worker(features: Array) -> Array:
        return linear(weights, features)

    def copy(grey: bool) -> tuple[Policy, Aim]:
        made = Clone(cloned)

        def blinded(seen: Rows) -> Rows:
            return made.aim({**seen, "wrist": np.full_like(seen["wrist"], GREYNESS)})

        return made.policy, blinded if grey else made.aim

    return {
        LOOKING: lambda count: (worker, aim(count)),
        "linear policy": lambda _: (worker, None),
        "light spiral": lambda _: (LIGHT.policy(), None),
        "heavy spiral": lambda _: (HEAVY.policy(), None),
        "straight push": lambda _: (push, None),
        CLONED: lambda _: copy(False),
        GREY: lambda _: copy(True),
    }


FIRST_MOVE = 10
"""Actions in which a hand goes over the believed hole, as in a whole build."""


def misled(rival: Rival) -> Rival:
    """A rival that works after the hand has gone over the hole as it is believed."""

    def made(count: int) -> tuple[Policy, Aim | None]:
        policy, then = rival(count)
        left = FIRST_MOVE

        def act(features: Array) -> Array:
            nonlocal left
            action = policy(features)
            if left > 0:
                left -= 1
                action = np.clip(features[:, :3] * (1.0, 1.0, 0.0), -1.0, 1.0)
            return action

        return act, then

    return made


AT_ONCE = 20
"""Environments that work at the same time; episodes come in as many."""
FIRST_START = 100_001
"""The first of the held starts: training has those below."""
FIRST_SEED = 500_000
"""Of the episodes."""


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
    parser.add_argument("--goals", default="", help="goals whose steps are drawn, default all")
    parser.add_argument("--frame", default="free", choices=["free", "rigid"], help="how the standing parts hold")
    parser.add_argument("--policies", help="which of them, default all")
    parser.add_argument("--clone", default=str(clone.WEIGHTS), help="weights of the cloned policy")
    parser.add_argument("--misled", action="store_true", help="move the hand over the believed hole first")
    parser.add_argument("--table", help="a file to which a line for each policy is added: CSV")
    told = parser.parse_args()
    if told.episodes < 1 or told.episodes % AT_ONCE:
        parser.error(f"argument --episodes: found {told.episodes}, expected a multiple of {AT_ONCE}")
    try:
        cloned = clone.load(told.clone)
    except InputError as wrong:
        parser.error(str(wrong))
    known, goals = rivals(load(told.weights), cloned), tuple(filter(None, told.goals.split(",")))
    names, starts = told.policies.split(",") if told.policies else list(known), (FIRST_START, told.episodes)
    for name in names:
        if name not in known:
            parser.error(f"there is no policy {name!r}; there are {', '.join(known)}")
    for world in told.worlds.split(","):
        blind, seeing = (
            environments(world, AT_ONCE, starts, 0.0, frame=told.frame, goals=goals, image=image)
            for image in (None, IMAGE)
        )
        for error in told.errors.split(","):
            for name in names:
                env = seeing if name in SEEING else blind
                rival = misled(known[name]) if told.misled else known[name]
                won, median = judge(env, rival, 1e-3 * float(error), told.episodes)
                low, high = interval(won, told.episodes)
                share = f"{won} of {told.episodes}, {low:.1f} to {high:.1f} %"
                print(f"{world}  {error} mm  {name:21}  {share}  {median:.2f} s", flush=True)
                if told.table is not None:
                    with open(told.table, "a", encoding="utf-8") as file:
                        file.write(f"{world},{error},{name},{won},{told.episodes},{median:.2f}\n")


if __name__ == "__main__":
    main()

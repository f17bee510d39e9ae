"""A linear policy for `fasten`, from pose and force to motion, learned by an evolution strategy.

It needs numpy alone.

The peg is in the hand over its hole, whose place is known to a millimetre or two. The policy moves the target
of a Cartesian impedance 20 times a second. It has no memory: it has learned how force and velocity move the
target.

    python -m ramp.policies.fasten -o weights.npy     trains, about half an hour on one core
    python -m ramp.policies.judge weights.npy         held starts, beside a straight push and two spirals
"""

from __future__ import annotations

import argparse
import pathlib
import time
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ramp._core import Driver, Robot, benchmark
from ramp._core import Observation as Seen
from ramp.agent import Skill, Task

Array = NDArray[np.float64]
Rows = dict[str, Any]

STEM = 33.2e-3
"""How far the peg's stem reaches below its head, m: beyond that height the tip is over the plate."""
RATE = 20.0
"""Actions a second."""
STIFFNESS = 1500.0
"""Of the impedance along each axis, N/m."""
LIMIT = 6.0
"""Time of an episode, s."""
TRAINED = 3.5
"""The same in training, where a search that takes longer costs more than it teaches."""
SETTINGS: dict[str, Any] = {"action": "cartesian", "turns": False, "speed": 0.03, "leash": [0.005, 0.005, 0.016]}
"""How actions move the hand: 30 mm/s at most, with up to 7.5 N sideways and 24 N down."""
WEIGHTS = pathlib.Path(__file__).with_name("fasten.npy")
FEATURES = 19


class Features:
    """What the policy sees, as numbers of about one. Rows are environments."""

    def __init__(self, count: int) -> None:
        self.force = np.zeros((count, 5))
        self.tip: Array | None = None
        self.action = np.zeros((count, 3))

    def __call__(self, seen: Rows) -> Array:
        """Of one more observation: fields ``error``, ``wrench``, ``tip`` and ``lead`` of an environment."""
        error, tip = np.asarray(seen["error"], float), np.asarray(seen["tip"], float)[:, :3]
        wrench, lead = np.asarray(seen["wrench"], float), np.asarray(seen["lead"], float)[:, :3]
        felt = np.concatenate([wrench[:, :3] / 10.0, wrench[:, 3:5] / 0.5], axis=1)
        self.force = felt if self.tip is None else 0.5 * (self.force + felt)
        velocity = np.zeros_like(tip) if self.tip is None else (tip - self.tip) * RATE / 0.02
        self.tip = tip
        over = -error[:, 2:3] - STEM
        return np.concatenate(
            [
                np.clip(error[:, :2] / 3e-3, -3.0, 3.0),
                np.clip(over / 1e-2, -3.5, 1.0),
                np.tanh(over / 1.5e-3),
                np.clip(self.force, -4.0, 4.0),
                np.clip(velocity, -3.0, 3.0),
                self.action,
                lead / np.array(SETTINGS["leash"]),
                np.ones((len(error), 1)),
            ],
            axis=1,
        )


def linear(weights: Array, features: Array) -> Array:
    """Actions of a policy, or of one a row. Shape of ``weights``: (3, FEATURES), or one of those a row."""
    return np.asarray(np.tanh(np.einsum("...ij,...j->...i", weights, features)))


def straight() -> Array:
    """Where learning begins: towards the hole as it is believed, and down."""
    weights = np.zeros((3, FEATURES))
    weights[0, 0] = weights[1, 1] = 1.0
    weights[2, FEATURES - 1] = -1.0
    return weights


def load(file: str | pathlib.Path = WEIGHTS) -> Array:
    """The weights that come with the package, or those of a file."""
    return np.asarray(np.load(file), float).reshape(3, FEATURES)


class FastenPolicy(Skill):
    """The policy as a skill of the baseline.

    >>> ramp.run("easy-1", skills=[FastenPolicy()], track="state").counted
    3
    """

    name = "linear-policy"
    serves = "fasten"

    def __init__(self, weights: Array | None = None) -> None:
        self.weights = load() if weights is None else weights

    def work(self, robot: Robot, task: Task) -> str | None:
        """Moves the peg until it is seated, as far as the hand tells."""
        held, mass, centre = task.held_pose, task.held_mass, task.held_centre
        if held is None or mass is None or centre is None:
            return "there is no peg in the hand"
        driver = Driver(benchmark(), robot, SETTINGS, task.width, task.force, False, (held, mass, centre))
        seen = driver.act(robot, np.zeros(3), 100)
        rest = seen.wrench
        features = Features(1)
        height = np.inf
        for _ in range(int(LIMIT * RATE)):
            part = seen.tip_position + turned(seen.tip_quat_wxyz, held[:3])
            error = task.goal_pose[:3] - part
            height = -float(error[2])
            if height < 3e-4:
                break
            action = linear(self.weights, features(row(error, seen, rest, driver)))[0]
            features.action = action[None]
            seen = driver.act(robot, action, round(1000 / RATE))
        # Pressed for a moment, so that the head comes to rest on the plate.
        driver.act(robot, [0.0, 0.0, -1.0], 300)
        return None if height < 2e-3 else f"the peg stands {height * 1e3:.1f} mm high after {LIMIT:.0f} s"


def row(error: Array, seen: Seen, rest: Array, driver: Driver) -> Rows:
    """An observation with the fields of an environment."""
    return {
        "error": error[None],
        "wrench": (seen.wrench - rest)[None],
        "tip": seen.tip_position[None],
        "lead": driver.lead(seen)[None],
    }


def turned(quat_wxyz: Array, vector: Array) -> Array:
    """A vector turned by a quaternion."""
    w, axis = quat_wxyz[0], quat_wxyz[1:]
    twice = 2.0 * np.cross(axis, vector)
    return np.asarray(vector + w * twice + np.cross(axis, twice))


def environments(
    world: str,
    count: int,
    starts: tuple[int, int],
    error: float,
    threads: int | None = None,
    limit: float = LIMIT,
    frame: str = "rigid",
    goals: tuple[str, ...] = (),
    image: int | None = None,
) -> Any:
    """Environments for training and judging: all pinned joints, holes believed off by ``error`` (m).

    ``goals``: default all; ``image``: pixels along each side of images of the wrist camera, default none.
    """
    from ramp.gym import RampVectorEnv

    settings = {key: value for key, value in SETTINGS.items() if key != "action"}
    if image is not None:
        settings.update(cameras=("wrist",), image_size=image)
    return RampVectorEnv(
        count, "fasten", goals, track="noisy", world=world, starts=starts, belief_error=error, gripper=False,
        frame=frame, rate=RATE, limit=limit, reward="shaped", autoreset_mode="DISABLED", threads=threads, **settings,
    )  # fmt: skip


Policy = Callable[[Array], Array]
Aim = Callable[[Rows], Rows]
"""Sets the field ``error`` of observations right."""


def episodes(env: Any, seeds: list[int], policy: Policy, aim: Aim | None = None) -> tuple[Array, Array, Array]:
    """One episode in each environment: returns, successes, and times, s."""
    seen, _ = env.reset(seed=seeds)
    count = env.num_envs
    features = Features(count)
    over = np.zeros(count, bool)
    returns, success, times = np.zeros(count), np.zeros(count, bool), np.full(count, LIMIT)
    for step in range(int(LIMIT * RATE) + 1):
        features.action = policy(features(seen if aim is None else aim(seen)))
        seen, reward, terminated, truncated, told = env.step(features.action)
        returns += np.where(over, 0.0, reward)
        success |= ~over & told["success"]
        times = np.where(~over & terminated, (step + 1) / RATE, times)
        over |= terminated | truncated
        if over.all():
            break
    return returns, success, times


def train(
    generations: int,
    worlds: tuple[str, ...],
    starts: int,
    pairs: int = 12,
    seed: int = 0,
    begin: Array | None = None,
    output: str | pathlib.Path | None = None,
) -> Array:
    """An evolution strategy with mirrored samples from the same start; Adam on their differences."""
    random = np.random.default_rng(seed)
    envs = [environments(world, 2 * pairs, (1, starts), 1.7e-3, limit=TRAINED) for world in worlds]
    size = 3 * FEATURES
    mean = (straight() if begin is None else begin).ravel().copy()
    moment, square, average = np.zeros(size), np.zeros(size), mean.copy()
    sigma, rate = (0.2, 0.08) if begin is None else (0.12, 0.05)
    start, done = time.process_time(), 0
    for number in range(1, generations + 1):
        changes = random.standard_normal((pairs, size))
        weights = np.stack([mean + sigma * changes, mean - sigma * changes], axis=1).reshape(-1, 3, FEATURES)
        seeds = np.repeat(random.integers(2**31, size=pairs), 2).tolist()
        env = envs[(number - 1) % len(envs)]
        returns, success, _ = episodes(env, seeds, lambda seen, own=weights: linear(own, seen))  # type: ignore[misc]
        difference = returns[0::2] - returns[1::2]
        gradient = changes.T @ difference / (np.sqrt(np.mean(difference**2)) + 1e-8) / np.sqrt(pairs)
        done += len(returns)
        moment, square = 0.8 * moment + 0.2 * gradient, 0.98 * square + 0.02 * gradient**2
        mean += rate * (moment / (1 - 0.8**number)) / (np.sqrt(square / (1 - 0.98**number)) + 1e-6)
        mean *= 0.998
        average = 0.85 * average + 0.15 * mean
        if output is not None and number % 10 == 0:
            np.save(output, average.reshape(3, FEATURES))
        print(
            f"generation {number}  episodes {done}  CPU {time.process_time() - start:.0f} s"
            f"  return {returns.mean():.3f}  success {success.mean():.2f}",
            flush=True,
        )
    return np.asarray(average.reshape(3, FEATURES))


def main() -> None:
    """Trains, as the command line says."""
    parser = argparse.ArgumentParser(description="Trains a policy for `fasten`.")
    parser.add_argument("weights", nargs="?", help="to be trained on")
    parser.add_argument("-o", "--output", default="fasten.npy")
    parser.add_argument("--generations", type=int, default=20, help="of the evolution strategy, a world each by turns")
    parser.add_argument("--worlds", default="ideal,real")
    parser.add_argument("--starts", type=int, default=24, help="different starts to train on")
    told = parser.parse_args()
    begin = None if told.weights is None else load(told.weights)
    worlds = tuple(told.worlds.split(","))
    np.save(told.output, train(told.generations, worlds, told.starts, begin=begin, output=told.output))


if __name__ == "__main__":
    main()

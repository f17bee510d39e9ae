"""Speed and memory of `RAMP/Fasten-v0` at 20 Hz, each beside a reference measured in the same run.

    pip install '.[test]'
    python python/benchmarks/environments.py            some minutes
    python python/benchmarks/environments.py --short    under a minute

With the PyPI package `mujoco` installed, the engine's steps are compared with `mujoco.rollout` on the same
scene.
"""

from __future__ import annotations

import argparse
import importlib.util
import resource
import statistics
import time
from collections.abc import Callable
from typing import Any

import gymnasium
import numpy as np

from ramp.gym import RampEnv, RampVectorEnv

PERIODS = 50
"""Steps of the engine for each action, at 20 Hz."""
RUN = 250
"""Steps of a run of the rival: its torques stay as they are, and later the arm has sunk and the peg meets the
plate."""
FASTEN: dict[str, Any] = {"starts": (1, 1), "gripper": False, "turns": False}


def single() -> gymnasium.Env[Any, Any]:
    """One environment, with a peg in the hand over its hole."""
    return RampEnv("fasten", ["easy-3"], **FASTEN)


def vector(count: int, **more: Any) -> RampVectorEnv:
    """As many of them on threads, reset."""
    env = RampVectorEnv(count, "fasten", ["easy-3"], **{**FASTEN, **more})
    env.reset(seed=1)
    return env


def still(env: Any) -> np.ndarray[Any, Any]:
    """Actions that hold the hand where it is."""
    return np.zeros(env.action_space.shape, np.float32)


def rate(env: Any, actions: int, clock: Callable[[], float]) -> float:
    """Steps of the environment a second of a clock, over all that are in it."""
    held = still(env)
    for _ in range(3):
        env.step(held)
    start = clock()
    for _ in range(actions):
        env.step(held)
    return float(actions * getattr(env, "num_envs", 1) / (clock() - start))


def against_rollout(scale: int) -> None:
    """Engine steps a CPU-second over those of `mujoco.rollout`: same scene, state and number of copies.

    Both hold the peg over its hole: the rival with constant torques, so its runs are short.
    """
    if importlib.util.find_spec("mujoco") is None:
        print("engine steps: `pip install mujoco` to compare them with mujoco.rollout")
        return
    import mujoco
    from mujoco import rollout

    env = RampEnv("fasten", ["easy-3"], **FASTEN)
    env.reset(seed=1)
    model = mujoco.MjModel.from_xml_string(env.core.scene)
    data = mujoco.MjData(model)
    data.qpos[:], controls = env.core.physics()
    data.ctrl[:] = controls
    for _ in range(300):
        mujoco.mj_step(model, data)
    kind = mujoco.mjtState.mjSTATE_FULLPHYSICS
    state = np.zeros(mujoco.mj_stateSize(model, kind))
    mujoco.mj_getState(model, data, state, kind)
    resting = (data.qpos.copy(), data.ncon)
    mujoco.mj_step(model, data, RUN)
    if data.ncon != resting[1] or np.abs(data.qpos - resting[0]).max() > 0.02:
        raise RuntimeError("the rival's arm does not stay where it is: it would do other work")
    work = mujoco.MjData(model)
    for count in (1, 2, 16):
        runs = max(1, scale // (count * RUN))
        ours, theirs = [], []
        many = vector(count, threads=1)
        for _ in range(3):
            start = time.process_time()
            for _ in range(runs):
                rollout.rollout(model, [work], np.tile(state, (count, 1)), np.tile(controls, (count, RUN, 1)))
            theirs.append(runs * count * RUN / (time.process_time() - start))
            ours.append(PERIODS * rate(many, runs * RUN // PERIODS, time.process_time))
        best, rival = max(ours), max(theirs)
        print(
            f"{count:2} environments: {best:6.0f} engine steps a CPU-second,"
            f" {best / rival:.2f} of mujoco.rollout ({rival:.0f})"
        )


def against_async(actions: int) -> None:
    """Steps a second on the wall, over those of Gymnasium's processes around single environments."""
    count = 4
    rival = gymnasium.vector.AsyncVectorEnv([single] * count)
    rival.reset(seed=1)
    theirs = rate(rival, actions, time.perf_counter)
    rival.close()
    ours = rate(vector(count), actions, time.perf_counter)
    print(f"{count} environments: {ours:.0f} steps a second, {ours / theirs:.2f} of AsyncVectorEnv ({theirs:.0f})")


def with_camera(actions: int) -> None:
    """What an image of 84 pixels from the wrist takes."""
    blind = rate(vector(1, threads=1), actions, time.process_time)
    seeing = rate(vector(1, threads=1, cameras=["wrist"]), actions, time.process_time)
    print(
        f"steps a CPU-second: {blind:.0f}; with an image of 84 pixels from the wrist {seeing:.0f},"
        f" {seeing / blind:.2f} of it"
    )


def resets(count: int) -> None:
    """The time of a reset, and of a step beside it."""
    env = vector(1, starts=(1, 4), threads=1)
    for _ in range(20):
        env.reset()
    times = []
    for _ in range(count):
        start = time.perf_counter()
        env.reset()
        times.append(time.perf_counter() - start)
    step = 1.0 / rate(env, 20, time.perf_counter)
    median = statistics.median(times)
    print(f"reset: median {1e3 * median:.2f} ms, {median / step:.3f} of a step of the environment")


def memory(steps: int) -> None:
    """Memory of an environment, and what it grows by over many steps with their episodes."""

    def resident() -> float:
        with open("/proc/self/statm", encoding="ascii") as file:
            return int(file.read().split()[1]) * resource.getpagesize() / 1e6

    before = resident()
    count = 16
    env = vector(count, limit=2.0)
    held = still(env)
    env.step(held)
    each = (resident() - before) / count
    for _ in range(200):
        env.step(held)
    early = resident()
    for _ in range(steps // count):
        env.step(held)
    print(
        f"memory: {each:.1f} MB an environment, {resident() - early:+.1f} MB after"
        f" {steps // count * count} steps with their resets"
    )


def main() -> None:
    """Prints all figures."""
    parser = argparse.ArgumentParser(description="Speed and memory of RAMP/Fasten-v0 at 20 Hz.")
    parser.add_argument("--short", action="store_true", help="one quick pass, to see that it runs")
    parser.add_argument("--steps", type=int, help="steps of the environment over which memory is watched")
    told = parser.parse_args()
    short = bool(told.short)
    against_rollout(500 if short else 4000)
    against_async(10 if short else 200)
    with_camera(10 if short else 200)
    resets(20 if short else 200)
    memory(told.steps or (400 if short else 20_000))


if __name__ == "__main__":
    main()

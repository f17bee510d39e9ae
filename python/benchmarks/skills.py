"""Speed of environments by skill, goal, world and frame, with and without an image, and the cost of starts.

    pip install '.[test]'
    python python/benchmarks/skills.py            some minutes
    python python/benchmarks/skills.py --short    one row

Random actions push downwards at 20 Hz, the same in every row of a task. One environment on one core. The
first start of a seed is built and settled; a later reset copies it.
"""

from __future__ import annotations

import argparse
import time
from typing import Any

import numpy as np

from ramp.gym import RampEnv

ACTIONS = 150
"""At most so many actions in an episode."""
TASKS: list[tuple[str, list[str]]] = [
    ("fasten", ["easy-1"]),
    ("fasten", ["medium-2"]),
    ("fasten", ["hard-2"]),
    ("assemble-square", ["medium-2"]),
    ("slide", ["medium-3"]),
]


def episodes(env: RampEnv, count: int) -> tuple[float, float, float]:
    """Steps a CPU-second in random episodes, and CPU time (s) of a first start and of a later reset."""
    steps, stepping, first, later = 0, 0.0, 0.0, 0.0
    for seed in range(1, count + 1):
        begin = time.process_time()
        env.reset(seed=seed)
        first += time.process_time() - begin
        begin = time.process_time()
        env.reset(seed=seed)
        later += time.process_time() - begin
        draw = np.random.default_rng(seed)
        begin = time.process_time()
        for _ in range(ACTIONS):
            action = draw.uniform(-0.4, 0.4, env.action_space.shape).astype(np.float32)
            action[2] -= 0.5
            _, _, terminated, truncated, _ = env.step(action)
            steps += 1
            if terminated or truncated:
                break
        stepping += time.process_time() - begin
    return steps / stepping, first / count, later / count


def main() -> None:
    """Prints the table."""
    parser = argparse.ArgumentParser(description="Speed of environments by skill.")
    parser.add_argument("--short", action="store_true", help="one row, to see that it runs")
    short = bool(parser.parse_args().short)
    count = 1 if short else 4
    print("| skill | goal | world | frame | steps a CPU-second | with an image | first start, s | reset, ms |")
    print("|---|---|---|---|---|---|---|---|")
    for skill, goals in TASKS[:1] if short else TASKS:
        for world in ("ideal", "real"):
            for frame in ("rigid", "free"):
                settings: dict[str, Any] = {
                    "world": world, "frame": frame, "starts": (1, count), "turns": False, "gripper": False,
                }  # fmt: skip
                plain, first, later = episodes(RampEnv(skill, goals, **settings), count)
                seeing, _, _ = episodes(RampEnv(skill, goals, cameras=["wrist"], **settings), count)
                print(
                    f"| `{skill}` | {', '.join(goals)} | `{world}` | `{frame}` | {plain:.0f} | {seeing:.0f}"
                    f" | {first:.2f} | {1e3 * later:.2f} |",
                    flush=True,
                )


if __name__ == "__main__":
    main()

"""The policy with eyes: whole builds beside the baseline, and the plot of its curve.

    python python/benchmarks/looking.py builds builds.csv easy medium --seeds 1 2 3 4 5
    python python/benchmarks/looking.py plot measured/looking.csv docs/src/pictures/looking.svg

`python -m ramp.policies.judge --table looking.csv` writes the numbers of the curve.
"""

from __future__ import annotations

import argparse
import collections
import csv
import pathlib

import ramp
from ramp.policies.judge import interval
from ramp.policies.looking import LookingPolicy

COLOURS = {"with images": "#1b9e77", "linear policy": "#1f77b4", "light spiral": "#d95f02"}
CLASSES = ("easy", "medium", "hard")
LEFT, RIGHT, TOP, BOTTOM = 56.0, 500.0, 16.0, 256.0
"""Edges of the plot, pixels."""


def builds(table: pathlib.Path, goals: list[str], seeds: list[int]) -> None:
    """Adds a line for each episode on `tags`: the baseline, and the baseline whose `fasten` has eyes."""
    names = [name for goal in goals for name in (ramp.goals.of_class(goal) if goal in CLASSES else [goal])]
    with table.open("a", encoding="utf-8") as file:
        for goal in names:
            for seed in seeds:
                for skills in ([], [LookingPolicy()]):
                    result = ramp.run(goal, skills=skills, track="tags", seed=seed)
                    pegs = len(result.pegs)
                    name = "with images" if skills else "baseline"
                    file.write(f"{goal},{seed},{name},{result.counted},{pegs},{result.time.robot:.1f}\n")
                    file.flush()
                    print(
                        goal,
                        seed,
                        result.agent,
                        f"{result.counted} of {pegs}",
                        f"{result.time.robot:.1f} s",
                        flush=True,
                    )


def plot(table: pathlib.Path, picture: pathlib.Path, world: str) -> None:
    """Draws the shares of seated pegs against the error, with intervals of 95 %."""
    curves: dict[str, list[tuple[float, int, int]]] = collections.defaultdict(list)
    with table.open(encoding="utf-8") as file:
        for row in csv.DictReader(file):
            if row["world"] == world:
                curves[row["policy"]].append((float(row["error_mm"]), int(row["seated"]), int(row["episodes"])))
    most = max(point[0] for points in curves.values() for point in points)
    lines = [
        '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 640 300" font-family="sans-serif" font-size="12"'
        ' fill="#333">',
        '<rect width="640" height="300" fill="#fff"/>',
    ]
    for share in (0, 25, 50, 75, 100):
        y = _y(share)
        lines.append(f'<line x1="{LEFT}" x2="{RIGHT}" y1="{y:.1f}" y2="{y:.1f}" stroke="#ddd"/>')
        lines.append(f'<text x="{LEFT - 8}" y="{y + 4:.1f}" text-anchor="end">{share} %</text>')
    for error in range(int(most) + 1):
        x = _x(error, most)
        lines.append(f'<line x1="{x:.1f}" x2="{x:.1f}" y1="{BOTTOM}" y2="{BOTTOM + 5}" stroke="#333"/>')
        lines.append(f'<text x="{x:.1f}" y="{BOTTOM + 18}" text-anchor="middle">{error}</text>')
    words = "error of the believed hole along x and along y, 1 σ, mm"
    lines.append(f'<text x="{(LEFT + RIGHT) / 2}" y="{BOTTOM + 36}" text-anchor="middle">{words}</text>')
    for number, (name, points) in enumerate(curves.items()):
        lines += _curve(name, sorted(points), most, number)
    picture.write_text("\n".join([*lines, "</svg>", ""]), encoding="utf-8")


def _curve(name: str, points: list[tuple[float, int, int]], most: float, number: int) -> list[str]:
    colour = COLOURS.get(name, "#777")
    spots = [(_x(error, most) + 2.0 * (number - 1), _y(100.0 * won / count)) for error, won, count in points]
    way = " ".join(f"{x:.1f},{y:.1f}" for x, y in spots)
    lines = [f'<polyline fill="none" stroke="{colour}" stroke-width="2" points="{way}"/>']
    for (x, y), (_, won, count) in zip(spots, points, strict=True):
        low, high = (_y(share) for share in interval(won, count))
        lines.append(f'<line x1="{x:.1f}" x2="{x:.1f}" y1="{low:.1f}" y2="{high:.1f}" stroke="{colour}"/>')
        lines.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="3" fill="{colour}"/>')
    at = TOP + 24.0 + 20.0 * number
    lines.append(f'<line x1="514" x2="534" y1="{at}" y2="{at}" stroke="{colour}" stroke-width="2"/>')
    lines.append(f'<text x="540" y="{at + 4}">{name}</text>')
    return lines


def _x(error: float, most: float) -> float:
    return LEFT + 16.0 + (RIGHT - LEFT - 32.0) * error / most


def _y(share: float) -> float:
    return BOTTOM - (BOTTOM - TOP) * share / 100.0


def main() -> None:
    """Builds or plots, as the command line says."""
    parser = argparse.ArgumentParser(description="The policy with eyes: whole builds, and the plot of its curve.")
    tasks = parser.add_subparsers(dest="task", required=True)
    build = tasks.add_parser("builds")
    build.add_argument("table", type=pathlib.Path)
    build.add_argument("goals", nargs="+", help="goals or classes")
    build.add_argument("--seeds", type=int, nargs="+", default=[1, 2, 3, 4, 5])
    draw = tasks.add_parser("plot")
    draw.add_argument("table", type=pathlib.Path)
    draw.add_argument("picture", type=pathlib.Path)
    draw.add_argument("--world", default="real")
    told = parser.parse_args()
    if told.task == "builds":
        builds(told.table, told.goals, told.seeds)
    else:
        plot(told.table, told.picture, told.world)


if __name__ == "__main__":
    main()

"""The card of a data set: its ``README.md``, with the head that the hub of LeRobot reads."""

from __future__ import annotations

from typing import Any

HEAD = """---
task_categories:
- robotics
tags:
- {tag}
- ramp
configs:
- config_name: default
  data_files: data/*/*.parquet
---

"""


def text(told: dict[str, Any]) -> str:
    """The card of what ``meta/ramp.json`` says."""
    episodes = told["episodes"]
    good = sum(bool(it["success"]) for it in episodes)
    lines = [
        f"# {_title(told)}",
        "",
        f"{len(episodes)} episodes in the digital twin of RAMP {told['version']}, {good} of them successful.",
        "Failures are kept and marked. `ramp replay --dataset DIR` plays each episode again and compares its end.",
        "",
        "| | |",
        "|---|---|",
        f"| format | {told['format']} |",
        f"| rate | {told['rate']} Hz |",
        f"| state | {', '.join(f'{name} ({count})' for name, count in told['fields'].items())} |",
        f"| action | {', '.join(told['action'])} |",
        f"| cameras | {_cameras(told)} |",
        "",
        "Seeds, arguments, the end of each episode, and the cameras' lenses and mountings are in `meta/ramp.json`.",
        "Units are m, rad, s, N and N·m; quaternions are w, x, y, z; the world's frame is that of the robot's base.",
        "",
    ]
    head = HEAD.format(tag="LeRobot") if told["format"] == "lerobot" else ""
    return head + "\n".join(lines)


def _title(told: dict[str, Any]) -> str:
    if told["kind"] == "skill":
        return f"Demonstrations of {told['environment']}"
    goals = sorted({it["goal"] for it in told["episodes"]})
    return f"Demonstrations of {', '.join(goals)}"


def _cameras(told: dict[str, Any]) -> str:
    size = told["image_size"]
    depth = ", with depth" if told["depth"] else ""
    return ", ".join(f"{key} ({size} × {size}{depth})" for key in told["cameras"]) or "none"

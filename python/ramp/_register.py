"""The ids of the environments, and the version of Gymnasium that they need.

Gymnasium is optional: nothing here fails without it, or beside a version that is too old.
"""

from __future__ import annotations

import importlib
import re
from typing import Any

NEEDED = (1, 1)
"""Oldest version of Gymnasium with which the environments work."""

GOALS = {
    "Easy1": "easy-1", "Easy2": "easy-2", "Easy3": "easy-3",
    "Medium1": "medium-1", "Medium2": "medium-2", "Medium3": "medium-3",
    "Hard1": "hard-1", "Hard2": "hard-2", "Hard3": "hard-3",
}  # fmt: skip
"""Whole goals: name in the id, and the goal."""

SKILLS = {
    "Fasten": "fasten",
    "FastenInF": "fasten-in-f", "FastenInFEnd": "fasten-in-f-end",
    "FastenThruF": "fasten-thru-f", "FastenAngleF": "fasten-angle-f",
    "AssembleSquare": "assemble-square", "AssembleThrough": "assemble-through",
    "AssembleCap": "assemble-cap", "AssembleDeep": "assemble-deep",
    "LayDown": "lay-down", "Slide": "slide", "Push": "push", "PickUpPeg": "pick-up-peg",
}  # fmt: skip
"""Skills: name in the id, and the skill. ``Fasten`` covers all four types of joints."""

IDS = tuple(f"RAMP/{name}-v0" for name in (*GOALS, *SKILLS))
"""All ids of goals and skills."""

CHAIN = "RAMP/Chain-v0"
"""A whole goal, in which the environment executes one kind of action."""


def _arguments(name: str) -> dict[str, Any]:
    """The arguments of an id."""
    if name in GOALS:
        # A whole goal takes minutes: fast motions, and a long time limit.
        return {"goals": [GOALS[name]], "speed": 0.25, "turn_speed": 1.0, "limit": 600.0}
    skill = SKILLS[name]
    if skill.startswith("fasten"):
        return {"skill": skill, "turns": False, "gripper": False, "limit": 6.0}
    if skill in ("pick-up-peg", "push", "slide"):
        return {"skill": skill, "speed": 0.1, "turn_speed": 0.5, "limit": 15.0}
    return {"skill": skill, "speed": 0.06, "leash": (0.01, 0.01, 0.016), "limit": 15.0}


def problem() -> str | None:
    """Why the environments do not work here; nothing if they do."""
    needed = ".".join(map(str, NEEDED))
    remedy = f"the environments of ramp need Gymnasium {needed} or newer: pip install 'gymnasium>={needed}'"
    try:
        found = str(importlib.import_module("gymnasium").__version__)
    except Exception as error:
        return f"{remedy} (Gymnasium cannot be imported: {error})"
    numbers = re.match(r"(\d+)\.(\d+)", found)
    if numbers is None or (int(numbers[1]), int(numbers[2])) < NEEDED:
        return f"{remedy} (found {found})"
    return None


def _refuse(**_: Any) -> Any:
    """Takes the place of each environment beside a version of Gymnasium that is too old."""
    raise ImportError(problem())


def register() -> None:
    """Registers all ids with Gymnasium; idempotent. Beside an old version, each id names the one it needs."""
    import gymnasium

    fits = problem() is None
    entries: dict[str, dict[str, Any]] = {CHAIN: {"entry_point": "ramp.gym.chain:RampChainEnv"}}
    for name in (*GOALS, *SKILLS):
        entries[f"RAMP/{name}-v0"] = {
            "entry_point": "ramp.gym.env:RampEnv",
            "vector_entry_point": "ramp.gym.vector:RampVectorEnv",
            "kwargs": _arguments(name),
        }
    for env_id, entry in entries.items():
        if env_id not in gymnasium.registry:
            gymnasium.register(env_id, **(entry if fits else {"entry_point": _refuse}))

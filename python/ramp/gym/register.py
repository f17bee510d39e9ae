"""The ids of the environments."""

from __future__ import annotations

from typing import Any

import gymnasium

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


def register() -> None:
    """Registers all ids with Gymnasium; idempotent."""
    if CHAIN not in gymnasium.registry:
        gymnasium.register(CHAIN, entry_point="ramp.gym.chain:RampChainEnv")
    for name in (*GOALS, *SKILLS):
        env_id = f"RAMP/{name}-v0"
        if env_id in gymnasium.registry:
            continue
        gymnasium.register(
            env_id,
            entry_point="ramp.gym.env:RampEnv",
            vector_entry_point="ramp.gym.vector:RampVectorEnv",
            kwargs=_arguments(name),
        )

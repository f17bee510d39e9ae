"""Plans: coarse actions, and the fine actions that carry each of them out."""

from __future__ import annotations

import dataclasses
import json
import os
import pathlib
from typing import Any

from ramp._core import benchmark
from ramp.goal import Goal, as_goal


@dataclasses.dataclass(frozen=True)
class Plan:
    """A plan for a goal."""

    goal: str
    """Name of the goal."""
    steps: list[dict[str, Any]]
    """In order: ``coarse``, an action, and ``fine``, its fine actions. An action has its name in
    ``action``."""
    entries: list[dict[str, Any]]
    """How each beam gets to its place: direction in the assembly frame, distance and depth in m."""

    @property
    def coarse(self) -> list[dict[str, Any]]:
        """The coarse actions."""
        return [step["coarse"] for step in self.steps]

    @property
    def fine(self) -> list[dict[str, Any]]:
        """The fine actions of all steps."""
        return [action for step in self.steps for action in step["fine"]]

    def to_json(self) -> str:
        """As ``ramp plan GOAL --json`` prints it; ``ramp run GOAL --plan FILE`` takes it."""
        return json.dumps({"goal": self.goal, "plan": {"steps": self.steps, "entries": self.entries}})

    @staticmethod
    def from_json(text: str) -> Plan:
        """From what :meth:`to_json` gives."""
        value = json.loads(text.removeprefix("\ufeff"))
        plan = value["plan"]
        return Plan(goal=value["goal"], steps=plan["steps"], entries=plan.get("entries", []))

    def save(self, file: str | os.PathLike[str]) -> None:
        """Writes it to a file."""
        pathlib.Path(file).write_text(self.to_json() + "\n", encoding="utf-8")

    def __len__(self) -> int:
        return len(self.steps)


def plan(
    goal: str | os.PathLike[str] | Goal,
    *,
    domain: str | os.PathLike[str] | None = None,
    optimal: bool = False,
) -> Plan:
    """Plans a goal.

    Args:
        goal: A goal of the benchmark, a goal file, or a goal.
        domain: A file of rules in place of the one of its kind: a coarse or fine domain (``.al``), or the
            order (``.lp``).
        optimal: Prove that no plan has fewer coarse actions; takes much longer.

    Raises:
        ramp.InputError: Something is wrong in a file, with its line and column.
        ramp.PlanningError: There is no plan.

    """
    source = as_goal(goal).source
    rules = None if domain is None else os.fspath(domain)
    return Plan.from_json(benchmark().plan(source, rules, optimal))


def check(goal: str | os.PathLike[str] | Goal, text: str, *, domain: str | os.PathLike[str] | None = None) -> Plan:
    """Checks a plan of somebody else by the rules: JSON, or what a planner for PDDL has written.

    Raises:
        ramp.PlanningError: A step is not possible; the message names it.

    """
    rules = None if domain is None else os.fspath(domain)
    return Plan.from_json(benchmark().check_plan(as_goal(goal).source, text, rules))

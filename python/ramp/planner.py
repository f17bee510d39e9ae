"""Task planners in Python that make the baseline's plans."""

from __future__ import annotations

import dataclasses
import hashlib
import inspect
import json
from collections.abc import Callable
from typing import Any

from ramp._core import InputError, benchmark
from ramp.goal import Goal
from ramp.plan import Plan


@dataclasses.dataclass(frozen=True)
class Problem:
    """What a planner is asked."""

    goal: Goal
    """What is to be built."""
    state: dict[str, Any]
    """What stands already and what the arm cannot do, in the form of ``ramp plan --state``."""
    history: list[dict[str, Any]]
    """The events so far, as in a result."""
    domain: str | None = None
    """The file of rules in place of the built-in one of its kind."""

    def pddl(self) -> dict[str, str | None]:
        """The problem in PDDL: ``domain``, ``problem``, and in STRIPS ``strips_domain``, ``strips_problem``.

        What cannot be written is None.
        """
        texts = benchmark().pddl(self.goal.source, json.dumps(self.state), self.domain)
        return dict(zip(("domain", "problem", "strips_domain", "strips_problem"), texts, strict=True))


Planner = Callable[[Problem], str | Plan]
"""Makes a plan: its text in a form that ``ramp plan --from`` reads, or a plan."""


def asker(planner: Planner, goal: Goal, domain: str | None) -> Callable[[str], str]:
    """Asks a planner by JSON."""

    def ask(text: str) -> str:
        plan = planner(Problem(goal, domain=domain, **json.loads(text)))
        if isinstance(plan, Plan):
            return plan.to_json()
        if not isinstance(plan, str):
            raise InputError(f"the planner returned a {type(plan).__name__}, expected the text of a plan or a Plan")
        return plan

    return ask


def name_of(kind: str, own: Callable[..., Any]) -> str:
    """The name in results of what replaces a part of the baseline, with the start of the hash of its source.

    Without the hash where Python does not have the source.
    """
    kept = "".join(it for it in getattr(own, "__name__", "own") if it.isascii() and (it.isalnum() or it in "_-"))
    name = f"{kind}-{kept[:24] or 'own'}"
    try:
        source = inspect.getsource(own)
    except (OSError, TypeError):
        return name
    return f"{name}.{hashlib.sha256(source.encode()).hexdigest()[:8]}"


def planner_name(planner: Planner) -> str:
    """Its name in results, with the start of the hash of its source where Python has it."""
    return name_of("planner", planner)

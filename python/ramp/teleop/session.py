"""A session: one episode with an operator, and the files that it leaves."""

from __future__ import annotations

import contextlib
import pathlib
from typing import Any

from ramp._core import InputError, benchmark
from ramp.bench import run
from ramp.demos import formats
from ramp.demos.__main__ import record
from ramp.goal import Goal, goals
from ramp.result import Result
from ramp.teleop.operator import Operator, Source, TeleopAgent, TeleopSkill
from ramp.teleop.script import Script
from ramp.teleop.settings import Settings

INPUT = "input.txt"
"""File of a session's events."""
DEMONSTRATION = "demonstration"
"""Folder of its data set."""


def hold(asked: dict[str, Any], settings: Settings) -> Result:
    """Holds a session, and writes result, log, input and demonstration.

    ``asked`` has the arguments of ``ramp teleop``.

    Raises:
        ramp.InputError: An argument or the input is wrong.

    """
    formats.need(asked["format"])
    goal = _goal(asked)
    folder = pathlib.Path(asked["output"])
    stem = folder / f"{goal.name}-{asked['seed']}"
    window = None
    if asked["input"] is None:
        from ramp.teleop.window import Window

        window = Window(settings, f"RAMP teleoperation: {asked['what']}")
    source: Source = Script(pathlib.Path(asked["input"])) if window is None else window
    operator = Operator(source, settings, sees=asked["track"] == "tags")
    who: dict[str, Any] = {"agent": TeleopAgent(operator)}
    if asked["skill"]:
        who = {"skills": [TeleopSkill(asked["what"], operator)]}
    folder.mkdir(parents=True, exist_ok=True)
    log = stem.with_name(stem.name + ".mcap")
    try:
        result = run(
            goal,
            track=asked["track"],
            world=asked["world"],
            start=asked["start"],
            seed=asked["seed"],
            record=log,
            output=stem.with_name(stem.name + ".json"),
            progress=None if window is None else window.tick,
            **who,
        )
    except BaseException:
        with contextlib.suppress(OSError):
            folder.rmdir()
        raise
    finally:
        if window is not None:
            window.close()
    (folder / INPUT).write_text("\n".join(operator.lines) + "\n", encoding="utf-8")
    _demonstrate(log, folder / DEMONSTRATION, asked["format"], settings)
    return result


def _goal(asked: dict[str, Any]) -> Goal:
    """The goal of the session; for an action without one, the first of the benchmark whose plan has it."""
    if not asked["skill"]:
        return Goal.load(asked["what"])
    kind = asked["what"]
    names = [asked["goal"]] if asked["goal"] else list(goals)
    for name in names:
        if any(skill.startswith(kind) for _, skill, _ in benchmark().steps(name)):
            return Goal.load(name)
    raise InputError(f"the plan of {' and '.join(names)} has no action `{kind}`")


def _demonstrate(log: pathlib.Path, folder: pathlib.Path, form: str, settings: Settings) -> None:
    """Makes the data set of a log, as ``ramp demos --log`` does."""
    asked = {
        "what": None, "skill": False, "logs": [str(log)], "rate": settings.rate,
        "image_size": settings.demonstration_size, "depth": False, "format": form, "output": str(folder), "program": "",
    }  # fmt: skip
    record(asked)

"""Plays a data set again: each episode must end as it was recorded."""

from __future__ import annotations

import pathlib
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ramp._core import InputError, __version__
from ramp.demos import formats, logs, skills
from ramp.demos.collect import META, read_meta
from ramp.demos.progress import Bar


def replay(folder: pathlib.Path) -> dict[str, Any]:
    """Plays each episode of a data set; ``differences`` has a text for each that ends otherwise."""
    told = read_meta(folder)
    try:
        form, kind, episodes = str(told["format"]), str(told["kind"]), list(told["episodes"])
        formats.need(form)
        actions = list(formats.module(form).actions(folder))
        if len(actions) != len(episodes):
            raise InputError(f"{folder} has the actions of {len(actions)} episodes, and {META} names {len(episodes)}")
        play = _skill(told) if kind == "skill" else _logs(folder, told)
        bar = Bar(len(episodes))
        differences = []
        for index, (facts, rows) in enumerate(zip(episodes, actions, strict=True)):
            if (why := play(facts, rows)) is not None:
                differences.append({"episode": index, "why": why})
            bar.show(episodes[: index + 1])
        bar.end()
    except (KeyError, TypeError, AttributeError, OverflowError) as error:
        raise InputError(f"{folder}: the data set is not whole: {error!r}") from None
    except (OSError, ValueError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError(f"{folder}: the data set cannot be read: {error}") from None
    return {
        "episodes": len(episodes),
        "equal": len(episodes) - len(differences),
        "successful": sum(bool(it["success"]) for it in episodes),
        "differences": differences,
        "made_by": told["version"],
        "version": __version__,
    }


def _skill(told: dict[str, Any]) -> Any:
    """Plays actions in the environment of a skill."""
    env = skills.make(told["environment"], told["arguments"])

    def play(facts: dict[str, Any], actions: NDArray[np.float32]) -> str | None:
        env.reset(seed=int(facts["seed"]))
        over = success = False
        for index, action in enumerate(actions):
            if over:
                return f"it ends after {index} of {len(actions)} actions"
            _, _, terminated, truncated, info = env.step(action)
            over, success = terminated or truncated, bool(info["success"])
        if not over:
            return f"it is not over after its {len(actions)} actions"
        if success != facts["success"]:
            return f"success is {success}, and {facts['success']} in the data set"
        return _compare(env.core.state_hash, facts["state"])

    return play


def _logs(folder: pathlib.Path, told: dict[str, Any]) -> Any:
    """Runs the logs of a data set again, and compares the actions, too."""
    description = logs.describe(int(told["rate"]), str(told["kind"]), {})

    def play(facts: dict[str, Any], actions: NDArray[np.float32]) -> str | None:
        name = pathlib.PurePosixPath(facts["log"]).name
        again, samples = logs.sample(folder / "meta/logs" / name, description)
        if not again["equal"]:
            return str(again["differences"][0])
        if again["sha256"] != facts["sha256"]:
            return "its log is another one"
        if not np.array_equal(logs.targets(samples), actions):
            return "its actions are not those of its log"
        return _compare(again["state"], facts["state"])

    return play


def _compare(found: str, expected: str) -> str | None:
    if found == expected:
        return None
    return f"the physics end in the state {found}, and in {expected} in the data set"

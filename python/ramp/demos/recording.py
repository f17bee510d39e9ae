"""What a request of `ramp demos` records: the description of its data set, and each of its episodes."""

from __future__ import annotations

import pathlib
import shutil
import subprocess
from typing import Any

from ramp._core import InputError, benchmark
from ramp.demos import logs
from ramp.demos.collect import Record
from ramp.demos.episode import Description, Episode

Recording = tuple[Description, int, Record]
"""The description, the number of episodes, and what records one of them."""


def of(asked: dict[str, Any], program: str) -> Recording:
    """The recording of a request, which gets the files of its logs; ``program`` is the `ramp` command."""
    if asked["logs"]:
        return _from_logs(asked)
    return _of_skill(asked) if asked["skill"] else _of_goal(asked, program)


def _of_skill(asked: dict[str, Any]) -> Recording:
    from ramp.demos.skills import SkillRecorder

    names = ("goals", "world", "start", "track", "belief_error")
    views = {"size": asked["image_size"], "depth": asked["depth"]}
    recorder = SkillRecorder(asked["what"], **views, **{name: asked[name] for name in names})
    if asked["rate"] != recorder.description.rate:
        raise InputError(f"the policy of `{asked['what']}` acts {recorder.description.rate} times a second")

    def one(index: int, _: pathlib.Path) -> Episode:
        return recorder.record(asked["seed"] + index)

    return recorder.description, asked["episodes"], one


def _of_goal(asked: dict[str, Any], program: str) -> Recording:
    options = {name: asked[name] for name in ("world", "start", "track")}
    arguments = options | ({"agent": asked["agent"]} if asked["agent"] else {})
    description = logs.describe(
        asked["rate"], "goal", {"arguments": arguments},
        size=asked["image_size"], depth=asked["depth"], touch=benchmark().has_touch(asked["world"]),
    )  # fmt: skip

    def one(index: int, stage: pathlib.Path) -> Episode:
        log = stage / f"episode-{index:06d}.mcap"
        result = stage / "result.json"
        command = [program, "run", asked["what"], "--seed", str(asked["seed"] + index)]
        for name, value in arguments.items():
            command += [f"--{name}", value]
        command += ["--record", str(log), "--output", str(result)]
        log.unlink(missing_ok=True)
        result.unlink(missing_ok=True)
        done = subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, check=False)
        if not log.is_file():
            raise InputError(done.stderr.strip() or f"the episode ended with exit status {done.returncode}")
        return logs.record(log, description)

    return description, asked["episodes"], one


def _from_logs(asked: dict[str, Any]) -> Recording:
    files: list[pathlib.Path] = []
    for path in map(pathlib.Path, asked["logs"]):
        found = sorted(path.glob("*.mcap")) if path.is_dir() else [path]
        if not found:
            raise InputError(f"{path}: there is no log in this folder")
        files += found
    touch = logs.has_touch(files[0])
    for file in files[1:]:
        if logs.has_touch(file) != touch:
            have, lack = (files[0], file) if touch else (file, files[0])
            raise InputError(f"{have} has tactile sensors, and {lack} has none: make a data set of each")
    description = logs.describe(asked["rate"], "logs", {}, size=asked["image_size"], depth=asked["depth"], touch=touch)

    def one(index: int, stage: pathlib.Path) -> Episode:
        episode = logs.record(files[index], description)
        shutil.copyfile(files[index], stage / f"episode-{index:06d}.mcap")
        return episode

    asked["files"] = [str(file) for file in files]
    return description, len(files), one

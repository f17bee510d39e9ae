"""What `ramp demos` and `ramp replay --dataset` start: `python -m ramp.demos record|replay JSON`.

The arguments come as one object of JSON, which the `ramp` command has checked. Exit status: 0 done; 1 an
episode ends otherwise than it was recorded; 2 bad input; 3 the machine failed, such as a full disk.
"""

from __future__ import annotations

import json
import pathlib
import shutil
import signal
import subprocess
import sys
from typing import Any

from ramp._core import InputError
from ramp.demos import formats, logs
from ramp.demos.collect import collect
from ramp.demos.episode import Episode
from ramp.demos.replay import replay

DONE, DIFFERENT, BAD_INPUT, MACHINE = 0, 1, 2, 3


def record(asked: dict[str, Any]) -> int:
    """Makes a data set."""
    formats.need(asked["format"])
    folder = pathlib.Path(asked.pop("output"))
    program = asked.pop("program")
    if asked["logs"]:
        told = _from_logs(folder, asked)
    elif asked["skill"]:
        told = _of_skill(folder, asked)
    else:
        told = _of_goal(folder, asked, program)
    episodes = told["episodes"]
    good = sum(bool(it["success"]) for it in episodes)
    size = sum(it.stat().st_size for it in folder.rglob("*") if it.is_file())
    print(f"{folder}: {len(episodes)} episodes, {good} successful, {size / 1e6:.1f} MB, format {told['format']}")
    return DONE


def _of_skill(folder: pathlib.Path, asked: dict[str, Any]) -> dict[str, Any]:
    from ramp.demos.skills import SkillRecorder

    names = ("goals", "world", "start", "track", "belief_error")
    recorder = SkillRecorder(asked["what"], size=asked["image_size"], **{name: asked[name] for name in names})
    if asked["rate"] != recorder.description.rate:
        raise InputError(f"the policy of `{asked['what']}` acts {recorder.description.rate} times a second")

    def one(index: int, _: pathlib.Path) -> Episode:
        return recorder.record(asked["seed"] + index)

    return collect(folder, asked["format"], asked, recorder.description, asked["episodes"], one)


def _of_goal(folder: pathlib.Path, asked: dict[str, Any], program: str) -> dict[str, Any]:
    options = {name: asked[name] for name in ("world", "start", "track")}
    arguments = options | ({"agent": asked["agent"]} if asked["agent"] else {})
    description = logs.describe(asked["rate"], asked["image_size"], "goal", {"arguments": arguments})

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

    return collect(folder, asked["format"], asked, description, asked["episodes"], one)


def _from_logs(folder: pathlib.Path, asked: dict[str, Any]) -> dict[str, Any]:
    files: list[pathlib.Path] = []
    for path in map(pathlib.Path, asked["logs"]):
        found = sorted(path.glob("*.mcap")) if path.is_dir() else [path]
        if not found:
            raise InputError(f"{path}: there is no log in this folder")
        files += found
    description = logs.describe(asked["rate"], asked["image_size"], "logs", {})

    def one(index: int, stage: pathlib.Path) -> Episode:
        episode = logs.record(files[index], description)
        shutil.copyfile(files[index], stage / f"episode-{index:06d}.mcap")
        return episode

    asked["files"] = [str(file) for file in files]
    return collect(folder, asked["format"], asked, description, len(files), one)


def play(asked: dict[str, Any]) -> int:
    """Plays a data set again."""
    told = replay(pathlib.Path(asked["dataset"]))
    if asked["json"]:
        print(json.dumps(told, indent=2))
    else:
        count = told["episodes"]
        print(f"{told['equal']} of {count} episodes end as recorded, to the last bit; {told['successful']} succeed")
        for it in told["differences"]:
            print(f"  episode {it['episode']}: {it['why']}")
        if told["differences"] and told["made_by"] != told["version"]:
            print(f"the data set was made by ramp {told['made_by']}, and this is {told['version']}: that may be why")
    return DIFFERENT if told["differences"] else DONE


def main(arguments: list[str]) -> int:
    """Does what the arguments say; the exit status."""
    # A call may end at any moment: finished episodes are kept.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    work = {"record": record, "replay": play}
    if len(arguments) != 2 or arguments[0] not in work:
        print("usage: ramp demos, or ramp replay --dataset", file=sys.stderr)
        return BAD_INPUT
    try:
        return work[arguments[0]](json.loads(arguments[1]))
    except (InputError, ImportError) as error:
        print(f"Error: {error}", file=sys.stderr)
        return BAD_INPUT
    except OSError as error:
        print(f"Error: {error}; run the same command again to go on", file=sys.stderr)
        return MACHINE


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))

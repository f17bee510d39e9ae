"""What `ramp demos` and `ramp replay --dataset` start: `python -m ramp.demos record|replay JSON`.

The arguments come as one object of JSON, which the `ramp` command has checked. Exit status: 0 done; 1 an
episode ends otherwise than it was recorded; 2 bad input; 3 the machine failed, such as a full disk.
"""

from __future__ import annotations

import functools
import json
import pathlib
import signal
import sys
from typing import Any

from ramp._core import InputError
from ramp.demos import formats, recording
from ramp.demos.collect import collect
from ramp.demos.far import record as record_far
from ramp.demos.replay import replay

DONE, DIFFERENT, BAD_INPUT, MACHINE = 0, 1, 2, 3


def record(asked: dict[str, Any]) -> int:
    """Makes a data set."""
    formats.need(asked["format"])
    folder = pathlib.Path(asked.pop("output"))
    backend = asked.pop("backend", None)
    description, count, one = recording.of(asked, asked.pop("program"))
    far = None if backend is None else functools.partial(record_far, backend, asked)
    told = collect(folder, asked["format"], asked, description, count, one, far)
    episodes = told["episodes"]
    good = sum(bool(it["success"]) for it in episodes)
    size = sum(it.stat().st_size for it in folder.rglob("*") if it.is_file())
    print(f"{folder}: {len(episodes)} episodes, {good} successful, {size / 1e6:.1f} MB, format {told['format']}")
    return DONE


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

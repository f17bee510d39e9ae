"""What `ramp bench --backend ray` starts: `python -m ramp.ray`.

It talks with the `ramp` command over standard input and output. A message is a line of JSON, and the bytes
whose lengths it tells. First comes ``{"address", "program"}``, answered by ``ready``. Then comes, as often as
wanted, ``{"files": [{"name", "size", "executable"}], "jobs": [{"words", "files", "limit"}]}`` with the bytes
of the files, answered by ``ended`` or ``lost`` for each job. ``refused`` or ``failed`` is the last answer.
All ends when standard input closes.
"""

from __future__ import annotations

import contextlib
import json
import os
import queue
import signal
import subprocess
import sys
import threading
from collections.abc import Iterator
from typing import Any, BinaryIO

from ramp._core import InputError
from ramp.ray.engine import PROGRAM, RETRIES, connected, spread
from ramp.ray.program import Ended, File, work

DONE, BAD_INPUT, MACHINE = 0, 2, 3

Request = tuple[dict[str, Any], list[bytes]]


class Caller:
    """The `ramp` command that has started this process."""

    def __init__(self, requests: BinaryIO, answers: BinaryIO) -> None:
        self.answers = answers
        self.is_gone = threading.Event()
        self.queue: queue.Queue[Request | None] = queue.Queue()
        threading.Thread(target=self._read, args=(requests,), daemon=True).start()

    def _read(self, requests: BinaryIO) -> None:
        """Reads all requests, so that the end of the input is seen while jobs run."""
        with contextlib.suppress(ValueError):
            while line := requests.readline():
                request = json.loads(line)
                self.queue.put((request, [requests.read(file["size"]) for file in request.get("files", [])]))
        self.is_gone.set()
        self.queue.put(None)

    def requests(self) -> Iterator[Request]:
        """The requests, until the command is gone."""
        while (request := self.queue.get()) is not None:
            yield request

    def tell(self, kind: str, *contents: bytes, **fields: Any) -> None:
        """Answers."""
        self.answers.write(json.dumps({"kind": kind, **fields}).encode() + b"\n" + b"".join(contents))
        self.answers.flush()


def main(requests: BinaryIO, answers: BinaryIO) -> int:
    """Does what the command asks; the exit status."""
    caller = Caller(requests, answers)
    asked = caller.requests()
    try:
        hello, _ = next(asked, ({}, []))
        if not hello:
            return DONE
        check_program(hello["program"])
        with connected(hello["address"]) as ray:
            caller.tell("ready", processors=int(ray.cluster_resources().get("CPU", 1)))
            for request, contents in asked:
                serve(ray, caller, request, contents)
    except BrokenPipeError:
        # The command is gone.
        return DONE
    except InputError as error:
        caller.tell("refused", why=str(error))
        return BAD_INPUT
    except OSError as error:
        caller.tell("failed", why=str(error))
        return MACHINE
    return DONE


def check_program(expected: str) -> None:
    """Checks that the program of this package is of the same version as the one that asks."""
    if not PROGRAM.exists():
        raise InputError(f"the package has no program {PROGRAM}: install it with pip")
    found = subprocess.run([PROGRAM, "--version"], capture_output=True, text=True, check=False).stdout.strip()
    if found != expected:
        raise InputError(f"the program of the Python package is {found}, and this is {expected}: install the same one")


def serve(ray: Any, caller: Caller, request: dict[str, Any], contents: list[bytes]) -> None:
    """Runs the jobs of a request."""
    files = [File(file["name"], file["executable"]) for file in request["files"]]
    # Each node fetches a file once.
    kept = [ray.put(content) for content in contents]
    tasks = []
    for job in request["jobs"]:
        mine = [index for index, file in enumerate(files) if file.is_of(job["files"])]
        tasks.append((job, [files[index] for index in mine], *(kept[index] for index in mine)))
    for index, reference in spread(ray, work, tasks, caller.is_gone.is_set):
        try:
            ended = ray.get(reference)
        except ray.exceptions.RayTaskError as error:
            raise OSError(f"a node has failed: {error.cause}") from None
        except ray.exceptions.RayError as error:
            why = str(error).strip().splitlines()[0]
            caller.tell("lost", job=index, why=f"its worker was lost {RETRIES + 1} times: {why}")
            continue
        if not isinstance(ended, Ended):
            raise InputError(ended)
        caller.tell(
            "ended", ended.printed, ended.told, *(ended.files[name] for name in sorted(ended.files)),
            job=index, status=ended.status, took=ended.took, printed=len(ended.printed), told=len(ended.told),
            files={name: len(ended.files[name]) for name in sorted(ended.files)},
        )  # fmt: skip


if __name__ == "__main__":
    # The command ends this process by closing its input.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    # Only answers go to standard output, whatever the engine prints.
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    sys.exit(main(sys.stdin.buffer, answers))

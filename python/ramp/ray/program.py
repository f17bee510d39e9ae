"""The `ramp` command on a worker: it runs in a folder of its own, with the files that it needs."""

from __future__ import annotations

import dataclasses
import os
import pathlib
import subprocess
import sys
import tempfile
import time
from typing import Any

from ramp.ray.engine import PROGRAM, refusal

GUARDED = "guarded"
"""Only argument of a program that reads its arguments from its input, and ends when that closes."""

END = "\x04"
"""The last of those arguments."""

PATIENCE = 10.0
"""Time that a program has to end its processes, s."""


@dataclasses.dataclass(frozen=True)
class File:
    """A file that travels."""

    name: str
    """Its path in the worker's folder."""
    executable: bool

    def is_of(self, places: list[str]) -> bool:
        """Whether it is one of these files, or in one of these folders."""
        return any(self.name == place or self.name.startswith(f"{place}/") for place in places)


@dataclasses.dataclass(frozen=True)
class Ended:
    """A job that has ended."""

    status: int | None
    """Return code; None if it was stopped after its time."""
    took: float
    """s."""
    printed: bytes
    """What it wrote to standard output."""
    told: bytes
    """What it wrote to standard error."""
    files: dict[str, bytes]
    """The files of its folder ``out``."""


def work(driver: str, job: dict[str, Any], files: list[File], *contents: bytes) -> Ended | str:
    """Runs a job on a worker; why not, if this node is refused."""
    refused = refusal(driver)
    if refused is not None:
        return refused
    with tempfile.TemporaryDirectory() as folder:
        place = pathlib.Path(folder)
        for file, content in zip(files, contents, strict=True):
            path = place / file.name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(content)
            path.chmod(0o700 if file.executable else 0o600)
        return run(job, place)


def run(job: dict[str, Any], place: pathlib.Path) -> Ended:
    """Runs the command in a folder. Its arguments, the seed among them, are visible to no other process."""
    out, temporary = place / "out", place / "tmp"
    output, messages = place / "stdout", place / "stderr"
    out.mkdir()
    temporary.mkdir()
    path = os.pathsep.join([str(pathlib.Path(sys.executable).parent), os.environ.get("PATH", os.defpath)])
    environment = {**os.environ, "RAMP_PYTHON": sys.executable, "PATH": path, "TMPDIR": str(temporary)}
    # Options come as words.
    environment.pop("RAMP_DATA", None)
    begin = time.monotonic()
    with output.open("wb") as printed, messages.open("wb") as told, subprocess.Popen(
        [PROGRAM, GUARDED], cwd=place, env=environment, stdin=subprocess.PIPE, stdout=printed, stderr=told
    ) as child:  # fmt: skip
        assert child.stdin is not None
        # The pipe stays open: the program ends with this worker.
        child.stdin.write("".join(f"{word}\0" for word in [*job["words"], END]).encode())
        child.stdin.flush()
        status: int | None
        try:
            status = child.wait(timeout=job["limit"])
        except subprocess.TimeoutExpired:
            status = None
            child.terminate()
            try:
                child.wait(timeout=PATIENCE)
            except subprocess.TimeoutExpired:
                child.kill()
    took = time.monotonic() - begin
    files = {path.name: path.read_bytes() for path in sorted(out.iterdir()) if path.is_file()}
    return Ended(status, took, output.read_bytes(), messages.read_bytes(), files)

"""Episodes on more than one machine, by the engine Ray (the extra ``ray``).

:func:`ramp.bench` with ``backend="ray"`` makes a task of each episode. A task brings the files that its
options name and the result that the folder already has, runs :func:`ramp.run` on its worker, and brings
result and log back. Ray runs a task again whose worker or node was lost. The results equal those of one
machine but for planning and computing time.

``ramp bench --backend ray`` starts ``python -m ramp.ray``, which makes a task of each run of the command
(``program``). Both share the cluster and the check of its nodes (``engine``). ``vector`` keeps environments
in actors.
"""

from __future__ import annotations

import dataclasses
import os
import pathlib
import tempfile
from collections.abc import Callable, Iterator, Sequence
from typing import Any

from ramp._core import InputError
from ramp.ray import engine

FILES = ("world", "start", "domain", "parameters", "plan")
"""Options that may name a file."""

NAMED = ("world", "start")
"""Those that may be names instead."""

Answer = tuple[str, str, bytes]
"""``result``, its JSON and the log; or ``refused``, the reason and nothing."""


@dataclasses.dataclass(frozen=True)
class Call:
    """An episode, and its place in the folder of results."""

    arguments: dict[str, Any]
    """Of :func:`ramp.run`, but for agent, skills, record and output."""
    agent: Callable[[], Any] | None
    skills: Callable[[], Sequence[Any]] | None
    output: pathlib.Path | None
    """File for the result; the log goes beside it."""


def parse(backend: str) -> str | None:
    """The address in ``ray`` or ``ray:ADDRESS``; None for the cluster that runs here, or else a new one."""
    name, _, address = backend.partition(":")
    if name != "ray" or (":" in backend and not address):
        raise InputError(f"there is no backend {backend!r}: `ray` or `ray:ADDRESS` is expected")
    return address or None


def episodes(calls: Sequence[Call], address: str | None) -> Iterator[tuple[int, str]]:
    """Runs episodes; the index and the result, as JSON, of each as it is finished."""
    with engine.connected(address) as ray:
        tasks = [(call, files(call), kept(call)) for call in calls]
        for index, reference in engine.spread(ray, work, tasks):
            kind, text, log = ray.get(reference)
            if kind == "refused":
                raise InputError(text)
            keep(calls[index], text, log)
            yield index, text


def work(driver: str, call: Call, brought: dict[str, dict[str, bytes]], known: bytes | None) -> Answer:
    """Runs an episode on a worker."""
    import ramp

    refused = engine.refusal(driver)
    if refused is not None:
        return "refused", refused, b""
    with tempfile.TemporaryDirectory() as folder:
        place = pathlib.Path(folder)
        arguments = dict(call.arguments)
        for option, texts in brought.items():
            for name, content in texts.items():
                file = place / option / name
                file.parent.mkdir(parents=True, exist_ok=True)
                file.write_bytes(content)
            # A file, or a folder of plans.
            named = pathlib.Path(os.fspath(arguments[option])).name
            arguments[option] = place / option / named
        output, log = place / "result.json", place / "episode.mcap"
        if call.output is not None:
            arguments |= {"output": output, "record": log}
            if known is not None:
                output.write_bytes(known)
        try:
            result = ramp.run(
                agent=None if call.agent is None else call.agent(),
                skills=() if call.skills is None else call.skills(),
                **arguments,
            )
        except InputError as error:
            return "refused", str(error), b""
        return "result", result.json, log.read_bytes() if log.exists() else b""


def files(call: Call) -> dict[str, dict[str, bytes]]:
    """The content of the files that options name, by option and name; a folder's files below its name."""
    found: dict[str, dict[str, bytes]] = {}
    for option in FILES:
        value = call.arguments.get(option)
        if not isinstance(value, str | os.PathLike):
            continue
        path = pathlib.Path(value)
        # A world or start without an ending and a folder is a name, whatever lies here.
        if option in NAMED and path.suffix != ".toml" and len(path.parts) == 1:
            continue
        if path.is_dir():
            found[option] = {f"{path.name}/{it.name}": it.read_bytes() for it in sorted(path.iterdir()) if it.is_file()}
        elif path.is_file():
            found[option] = {path.name: path.read_bytes()}
    return found


def kept(call: Call) -> bytes | None:
    """The file that is already where the result goes: the worker decides whether it is of this episode."""
    return call.output.read_bytes() if call.output is not None and call.output.exists() else None


def keep(call: Call, text: str, log: bytes) -> None:
    """Writes the files of an episode, the result last: a folder never has half of one."""
    if call.output is None:
        return
    for path, content in ((call.output.with_suffix(".mcap"), log), (call.output, text.encode())):
        if content:
            part = path.with_name(f".{path.name}.part")
            part.write_bytes(content)
            part.replace(path)

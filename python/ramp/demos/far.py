"""Records episodes on a cluster of Ray, one on each processor. They equal those of one machine."""

from __future__ import annotations

import functools
import json
import os
import pathlib
import tempfile
from collections.abc import Iterator, Sequence
from typing import Any

from ramp._core import InputError
from ramp.demos import recording
from ramp.ray import engine

Files = dict[str, tuple[bytes, int]]
"""Content and mode of files, by their paths in the worker's folder."""


def record(
    backend: dict[str, Any], asked: dict[str, Any], indices: Sequence[int], stage: pathlib.Path
) -> Iterator[int]:
    """Records some episodes of a request into a folder; each index as it is finished."""
    if os.environ.get("RAMP_DATA"):
        raise InputError("the folder of `--data` does not travel: record on this machine")
    with engine.connected(backend["address"]) as ray:
        tasks = [(*packed(asked, index), index) for index in indices]
        for task, reference in engine.spread(ray, work, tasks):
            made = ray.get(reference)
            if isinstance(made, str):
                raise InputError(made)
            for name, content in made.items():
                part = stage / f"{name}.part"
                part.write_bytes(content)
                part.replace(stage / name)
            yield indices[task]


def work(driver: str, asked: dict[str, Any], files: Files, index: int) -> dict[str, bytes] | str:
    """Records an episode on a worker: its files by name, its own last; or why not."""
    refused = engine.refusal(driver)
    if refused is not None:
        return refused
    with tempfile.TemporaryDirectory() as folder:
        stage = pathlib.Path(folder)
        try:
            _, one = _recorder(json.dumps(asked), tuple(sorted(files.items())))
            # Of logs, a worker has that of its episode only.
            episode = one(0 if asked["logs"] else index, stage)
        except InputError as error:
            return str(error)
        if asked["logs"]:
            (stage / "episode-000000.mcap").replace(stage / f"episode-{index:06d}.mcap")
        logs = {it.name: it.read_bytes() for it in stage.glob("*.mcap")}
        name = f"episode-{index:06d}.npz"
        episode.save(stage / name)
        return {**logs, name: (stage / name).read_bytes()}


@functools.lru_cache(maxsize=1)
def _recorder(asked: str, files: tuple[tuple[str, tuple[bytes, int]], ...]) -> tuple[Any, Any]:
    """The folder with the files of a request, and what records its episodes: made once for a worker."""
    folder = tempfile.TemporaryDirectory()
    for name, (content, mode) in files:
        path = pathlib.Path(folder.name) / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content)
        path.chmod(mode)
    there = {key: _moved(value, pathlib.Path(folder.name)) for key, value in json.loads(asked).items()}
    _, _, one = recording.of(there, str(engine.PROGRAM))
    return folder, one


PLACE = "ray-file:"
"""Begins a path in the worker's folder within a request that travels."""


def _moved(value: Any, folder: pathlib.Path) -> Any:
    """A value of a request, with the paths of this worker."""
    if isinstance(value, list):
        return [_moved(it, folder) for it in value]
    if isinstance(value, str) and value.startswith(PLACE):
        return str(folder / value.removeprefix(PLACE))
    return value


def packed(asked: dict[str, Any], index: int) -> tuple[dict[str, Any], Files]:
    """The request as it travels for an episode, and the files that it names."""
    files: Files = {}

    def pack(value: str) -> str:
        path = pathlib.Path(value)
        name = f"{len(files)}/{path.name}"
        try:
            files[name] = (path.read_bytes(), path.stat().st_mode & 0o777)
        except OSError as error:
            raise InputError(f"{path} cannot be read: {error.strerror}") from None
        return PLACE + name

    def pack_named(value: str, ending: str) -> str:
        is_file = value.endswith(ending) or len(pathlib.Path(value).parts) > 1
        return pack(value) if is_file else value

    travelling = dict(asked)
    if asked["logs"]:
        travelling["logs"] = [pack(asked["files"][index])]
        travelling.pop("files")
    if asked["what"] is not None:
        travelling["what"] = pack_named(asked["what"], ".xml")
    travelling["goals"] = [pack_named(goal, ".xml") for goal in asked["goals"]]
    for name in ("world", "start"):
        travelling[name] = pack_named(asked[name], ".toml")
    if asked["agent"]:
        travelling["agent"] = pack(asked["agent"])
    return travelling, files

"""Makes a data set: each finished episode is kept at once, and the files are written when all are there."""

from __future__ import annotations

import json
import os
import pathlib
import shutil
from collections.abc import Callable, Iterator
from typing import Any

from ramp._core import InputError, __version__
from ramp.demos import card, formats
from ramp.demos.episode import SCHEMA, Description, Episode
from ramp.demos.progress import Bar

UNFINISHED = ".unfinished"
"""Folder within the data set with what is there so far."""
META = "meta/ramp.json"
"""What this program says of a data set."""

Record = Callable[[int, pathlib.Path], Episode]
"""Records the episode with a number, from 0; the folder takes further files that belong to the data set."""

Far = Callable[[list[int], pathlib.Path], Iterator[int]]
"""Records the episodes with these numbers elsewhere, into the folder; each number as it is finished."""


def collect(
    folder: pathlib.Path,
    form: str,
    request: dict[str, Any],
    description: Description,
    count: int,
    record: Record,
    far: Far | None = None,
) -> dict[str, Any]:
    """Makes a data set in a folder, or goes on where an earlier call with the same request was stopped.

    Returns what ``meta/ramp.json`` says.
    """
    formats.need(form)
    if (folder / META).is_file():
        told: dict[str, Any] = read_meta(folder)
        if told["request"] == request:
            return told
        raise InputError(f"{folder} is a data set that was made with other arguments")
    stage = _stage(folder, request)
    bar = Bar(count)
    files = [stage / f"episode-{index:06d}.npz" for index in range(count)]

    def here(indices: list[int], stage: pathlib.Path) -> Iterator[int]:
        for index in indices:
            record(index, stage).save(files[index])
            yield index

    known = {index: Episode.facts_of(file) for index, file in enumerate(files) if file.is_file()}
    missing = [index for index in range(count) if index not in known]
    for index in (far or here)(missing, stage):
        known[index] = Episode.facts_of(files[index])
        bar.show(list(known.values()))
    bar.end()
    facts = [known[index] for index in range(count)]
    told = _describe(form, request, description, files, facts)
    _write(folder, stage, form, description, files, told)
    return told


def _stage(folder: pathlib.Path, request: dict[str, Any]) -> pathlib.Path:
    """The folder of what is there so far, of this request."""
    stage = folder / UNFINISHED
    note = stage / "request.json"
    text = json.dumps(request, indent=1)
    if note.is_file():
        if json.loads(note.read_text(encoding="utf-8")) != request:
            raise InputError(f"{folder} has episodes of an unfinished data set with other arguments")
        return stage
    if folder.exists() and any(it.name != UNFINISHED for it in folder.iterdir()):
        raise InputError(f"{folder} is not empty")
    stage.mkdir(parents=True, exist_ok=True)
    part = note.with_suffix(".part")
    part.write_text(text, encoding="utf-8")
    os.replace(part, note)
    return stage


def _describe(
    form: str, request: dict[str, Any], description: Description, files: list[pathlib.Path], facts: list[dict[str, Any]]
) -> dict[str, Any]:
    episodes = []
    for file, told in zip(files, facts, strict=True):
        log = file.with_suffix(".mcap")
        named = {"log": f"meta/logs/{log.name}"} if log.is_file() else {}
        episodes.append({**told, **named})
    from ramp.demos.skills import lenses

    return {
        "schema": SCHEMA,
        "version": __version__,
        "format": form,
        "request": request,
        **description.source,
        "rate": description.rate,
        "image_size": description.size,
        "depth": bool(description.deep()),
        "fields": description.fields,
        "action": list(description.actions),
        "cameras": lenses(description.size) if description.size else {},
        "episodes": episodes,
    }


def _write(
    folder: pathlib.Path,
    stage: pathlib.Path,
    form: str,
    description: Description,
    files: list[pathlib.Path],
    told: dict[str, Any],
) -> None:
    """Writes the files beside the episodes, and moves them to their places; ``meta/ramp.json`` comes last."""
    out = stage / "out"
    shutil.rmtree(out, ignore_errors=True)
    out.mkdir()

    def episodes() -> Iterator[Episode]:
        for file in files:
            yield Episode.load(file)

    formats.module(form).write(out, description, episodes())
    (out / "meta").mkdir(exist_ok=True)
    for file in files:
        log = file.with_suffix(".mcap")
        if log.is_file():
            (out / "meta/logs").mkdir(exist_ok=True)
            shutil.copyfile(log, out / "meta/logs" / log.name)
    (out / "README.md").write_text(card.text(told), encoding="utf-8")
    note = stage / "ramp.json"
    note.write_text(json.dumps(told, indent=1), encoding="utf-8")
    for place in sorted(out.iterdir()):
        target = folder / place.name
        if target.is_dir():
            # Of a call that was stopped here.
            shutil.rmtree(target)
        os.replace(place, target)
    os.replace(note, folder / META)
    shutil.rmtree(stage)


def read_meta(folder: pathlib.Path) -> dict[str, Any]:
    """What ``meta/ramp.json`` of a data set says."""
    file = folder / META
    try:
        told = json.loads(file.read_text(encoding="utf-8"))
    except FileNotFoundError:
        raise InputError(f"{folder} is no data set of `ramp demos`: there is no {META}") from None
    except (OSError, ValueError, RecursionError) as error:
        raise InputError(f"{file} cannot be read: {error}") from None
    if not isinstance(told, dict) or told.get("schema") != SCHEMA:
        found = told.get("schema") if isinstance(told, dict) else told
        raise InputError(f"{file}: found schema {found!r}, expected {SCHEMA!r}")
    return told

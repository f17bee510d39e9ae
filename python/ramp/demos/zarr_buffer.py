"""Zarr in the layout of a replay buffer of diffusion policies: all steps in a row, and where episodes end."""

from __future__ import annotations

import pathlib
from collections.abc import Iterable, Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ramp._core import InputError
from ramp.demos.episode import Description, Episode

FOLDER = "demos.zarr"
CHUNK = 1024
"""Rows of numbers in a piece that is read at once."""
IMAGES = 16
"""Images in such a piece."""


def write(folder: pathlib.Path, description: Description, episodes: Iterable[Episode]) -> None:
    """Writes a data set into a folder."""
    import zarr

    # Version 2 of the format, which all programs read.
    newer = {"zarr_format": 2} if int(zarr.__version__.split(".")[0]) >= 3 else {}
    root = zarr.open_group(str(folder / FOLDER), mode="w", **newer)
    data, meta = root.create_group("data"), root.create_group("meta")
    arrays: dict[str, Any] = {}
    ends: list[int] = []
    successes: list[bool] = []
    for episode in episodes:
        rows: dict[str, NDArray[Any]] = {name: value[:-1] for name, value in episode.observations.items()}
        rows |= {f"{key}_image": value[:-1] for key, value in episode.images.items()}
        rows |= {f"{key}_depth": value[:-1] for key, value in episode.depths.items()}
        rows |= {"state": episode.state()[:-1], "action": episode.actions, "reward": episode.rewards}
        first = ends[-1] if ends else 0
        for name, values in rows.items():
            if name not in arrays:
                arrays[name] = _create(data, name, values)
            arrays[name].resize((first + len(episode), *values.shape[1:]))
            arrays[name][first:] = values
        ends.append(first + len(episode))
        successes.append(bool(episode.facts["success"]))
    for name, told in (("episode_ends", np.array(ends, np.int64)), ("episode_success", np.array(successes))):
        _create(meta, name, told)[:] = told


def _create(group: Any, name: str, values: NDArray[Any]) -> Any:
    """An array in a group, of the kind of some rows."""
    chunk = IMAGES if values.ndim == 4 else CHUNK
    create = group.create_array if hasattr(group, "create_array") else group.create_dataset
    return create(name, shape=values.shape, chunks=(chunk, *values.shape[1:]), dtype=values.dtype)


def actions(folder: pathlib.Path) -> Iterator[NDArray[np.float32]]:
    """The actions of each episode of a data set."""
    import zarr

    root = zarr.open_group(str(folder / FOLDER), mode="r")
    rows = np.asarray(root["data/action"][:], np.float32)
    first = 0
    for end in np.asarray(root["meta/episode_ends"][:]).tolist():
        yield rows[first:end]
        first = end


def read(
    folder: pathlib.Path, shapes: dict[str, tuple[int, ...]]
) -> tuple[dict[str, NDArray[Any]], list[int], list[bool]]:
    """Steps of a data set, the steps at which its episodes end, and which of them were successful.

    Args:
        folder: The data set.
        shapes: The arrays of ``data`` that are read, and the shape of a row of each.

    Raises `InputError` if an array is missing, or is not as it should be.

    """
    import zarr

    try:
        root = zarr.open_group(str(folder / FOLDER), mode="r")
        ends = np.asarray(root["meta/episode_ends"][:], np.int64).tolist()
        success = np.asarray(root["meta/episode_success"][:], bool).tolist()
        for name, shape in shapes.items():
            found, want = root[f"data/{name}"].shape, (ends[-1], *shape)
            if found != want:
                raise InputError(f"{folder}: data/{name} has the shape {found}, expected {want}")
        rows = {name: np.asarray(root[f"data/{name}"][:]) for name in shapes}
    except InputError:
        raise
    except (KeyError, IndexError, OSError, ValueError, RuntimeError) as error:
        raise InputError(f"{folder}: its zarr arrays cannot be read: {error}") from None
    if len(ends) != len(success) or any(first >= end for first, end in zip([0, *ends], ends, strict=False)):
        raise InputError(f"{folder}: its episodes do not follow each other")
    return rows, ends, success

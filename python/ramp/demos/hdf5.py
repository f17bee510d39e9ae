"""HDF5 in the layout of robomimic: a group for each episode in one file."""

from __future__ import annotations

import json
import pathlib
from collections.abc import Iterable, Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ramp.demos.episode import Description, Episode

FILE = "demos.hdf5"
GYM = 2
"""robomimic's number of environments of Gymnasium."""
HELD = 10
"""One episode in so many is in the mask ``valid``, all others are in ``train``."""


def write(folder: pathlib.Path, description: Description, episodes: Iterable[Episode]) -> None:
    """Writes a data set into a folder."""
    import h5py

    source = description.source
    arguments = {
        "env_name": source.get("environment", source["kind"]),
        "type": GYM,
        "env_kwargs": source.get("arguments", {}),
    }
    names: list[str] = []
    successful: list[str] = []
    with h5py.File(folder / FILE, "w") as file:
        data = file.create_group("data")
        total = 0
        for index, episode in enumerate(episodes):
            name = f"demo_{index}"
            _write_episode(data.create_group(name), episode)
            names.append(name)
            successful += [name] if episode.facts["success"] else []
            total += len(episode)
        data.attrs["total"] = total
        data.attrs["env_args"] = json.dumps(arguments)
        masks = {
            "train": [name for index, name in enumerate(names) if index % HELD],
            "valid": names[::HELD],
            "successful": successful,
        }
        for mask, members in masks.items():
            file.create_dataset(f"mask/{mask}", data=np.array(members, dtype="S"))


def _write_episode(group: Any, episode: Episode) -> None:
    group.attrs["num_samples"] = len(episode)
    group.attrs["seed"] = str(episode.facts["seed"])
    group.attrs["success"] = bool(episode.facts["success"])
    group.attrs["task"] = episode.facts["task"]
    group["actions"] = episode.actions
    group["rewards"] = episode.rewards
    group["dones"] = (np.arange(len(episode)) == len(episode) - 1).astype(np.int64)
    images: dict[str, NDArray[Any]] = {f"{key}_image": value for key, value in episode.images.items()}
    images |= {f"{key}_depth": value for key, value in episode.depths.items()}
    for name, rows in (episode.observations | images).items():
        group.create_dataset(f"obs/{name}", data=rows[:-1], compression="gzip")
        group.create_dataset(f"next_obs/{name}", data=rows[1:], compression="gzip")


def actions(folder: pathlib.Path) -> Iterator[NDArray[np.float32]]:
    """The actions of each episode of a data set."""
    import h5py

    with h5py.File(folder / FILE, "r") as file:
        for index in range(len(file["data"])):
            yield np.asarray(file[f"data/demo_{index}/actions"], np.float32)

"""A recorded episode, and the description of a data set."""

from __future__ import annotations

import dataclasses
import json
import os
import pathlib
from typing import Any

import numpy as np
from numpy.typing import NDArray

SCHEMA = "ramp-demos-1"
"""Version of ``meta/ramp.json``."""

DEPTH_UNIT = 1.0e-4
"""Unit of depth images, m, as on the track ``depth``."""

CAMERAS = {"wrist": "wrist", "birds-eye": "birds_eye"}
"""The cameras, and their names as keys of data sets."""


@dataclasses.dataclass
class Episode:
    """The steps of an episode. T is their number; observations have one row more, the last one's."""

    observations: dict[str, NDArray[np.float32]]
    """For each field its numbers, shape (T + 1, n)."""
    images: dict[str, NDArray[np.uint8]]
    """For each camera its images, shape (T + 1, size, size, 3)."""
    depths: dict[str, NDArray[np.uint16]]
    """For each camera the distance along its optical axis in each pixel, 0.1 mm, and 0 where there is none: shape
    (T + 1, size, size, 1). Empty without depth images."""
    actions: NDArray[np.float32]
    """Shape (T, n)."""
    rewards: NDArray[np.float32]
    """Shape (T,)."""
    facts: dict[str, Any]
    """What ``meta/ramp.json`` says of it: ``task`` (a sentence), ``success``, ``state`` (hash of the physics at
    the end), and what is needed to repeat it."""

    def __len__(self) -> int:
        return len(self.actions)

    def state(self) -> NDArray[np.float32]:
        """All numbers that were observed, in the order of the fields, shape (T + 1, n)."""
        return np.concatenate(list(self.observations.values()), axis=1)

    def save(self, file: pathlib.Path) -> None:
        """Writes it; the file appears when it is complete."""
        arrays: dict[str, Any] = {f"observations/{key}": value for key, value in self.observations.items()}
        arrays |= {f"images/{key}": value for key, value in self.images.items()}
        arrays |= {f"depths/{key}": value for key, value in self.depths.items()}
        text = np.frombuffer(json.dumps(self.facts).encode(), np.uint8)
        part = file.with_suffix(".part")
        with part.open("wb") as out:
            np.savez_compressed(out, actions=self.actions, rewards=self.rewards, facts=text, **arrays)
        os.replace(part, file)

    @staticmethod
    def facts_of(file: pathlib.Path) -> dict[str, Any]:
        """The facts of what :meth:`save` wrote, without its arrays."""
        with np.load(file, allow_pickle=False) as arrays:
            facts: dict[str, Any] = json.loads(bytes(arrays["facts"]))
            return facts

    @staticmethod
    def load(file: pathlib.Path) -> Episode:
        """Reads what :meth:`save` wrote."""
        with np.load(file, allow_pickle=False) as arrays:

            def under(head: str) -> dict[str, Any]:
                return {key.removeprefix(head): arrays[key] for key in arrays.files if key.startswith(head)}

            return Episode(
                observations=under("observations/"),
                images=under("images/"),
                depths=under("depths/"),
                actions=arrays["actions"],
                rewards=arrays["rewards"],
                facts=json.loads(bytes(arrays["facts"])),
            )


@dataclasses.dataclass(frozen=True)
class Description:
    """What all episodes of a data set share."""

    rate: int
    """Steps per second."""
    fields: dict[str, int]
    """The fields of an observation, and their numbers."""
    actions: tuple[str, ...]
    """A name for each number of an action."""
    size: int
    """Pixels along each side of an image; 0 without images."""
    depth: bool
    """Whether there are depth images, too."""
    source: dict[str, Any]
    """Where the episodes come from, as ``meta/ramp.json`` says it: ``kind`` and what belongs to it."""

    def state_names(self) -> list[str]:
        """A name for each number of the state."""
        return [name if count == 1 else f"{name}.{it}" for name, count in self.fields.items() for it in range(count)]

    def cameras(self) -> dict[str, str]:
        """The cameras of the images, and their names as keys."""
        return CAMERAS if self.size else {}

    def deep(self) -> dict[str, str]:
        """The cameras with depth images, and their names as keys."""
        return CAMERAS if self.size and self.depth else {}

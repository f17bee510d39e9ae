"""Statistics of a data set's columns: least, largest, mean, standard deviation and quantiles."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ramp.demos.episode import DEPTH_UNIT

QUANTILES = (1, 10, 50, 90, 99)
"""Which quantiles are told, %."""


def of_rows(rows: NDArray[Any]) -> dict[str, list[Any]]:
    """Of each number of some rows, shape (T, n)."""
    rows = np.asarray(rows, np.float64).reshape(len(rows), -1)
    told: dict[str, list[Any]] = {
        "min": rows.min(0).tolist(),
        "max": rows.max(0).tolist(),
        "mean": rows.mean(0).tolist(),
        "std": rows.std(0).tolist(),
        "count": [len(rows)],
    }
    for share in QUANTILES:
        told[f"q{share:02d}"] = np.quantile(rows, share / 100, axis=0).tolist()
    return told


class Counts:
    """How often each value of each channel occurs in some images."""

    def __init__(self, channels: int, values: int, unit: float) -> None:
        """For images of that many channels and possible values, counted in a unit."""
        self.counts = np.zeros((channels, values), np.int64)
        self.unit = unit
        self.images = 0

    @staticmethod
    def of_colours() -> Counts:
        """For red, green and blue from 0 to 1, stored in 8 bits."""
        return Counts(3, 256, 1.0 / 255.0)

    @staticmethod
    def of_depths() -> Counts:
        """For distances in m, stored in 16 bits."""
        return Counts(1, 1 << 16, DEPTH_UNIT)

    def add(self, images: NDArray[Any]) -> None:
        """Counts images of shape (T, height, width, channels)."""
        for channel, counts in enumerate(self.counts):
            counts += np.bincount(images[..., channel].ravel(), minlength=len(counts))
        self.images += len(images)

    def __iadd__(self, other: Counts) -> Counts:
        self.counts += other.counts
        self.images += other.images
        return self

    def told(self) -> dict[str, list[Any]]:
        """The statistics, in units, shape (channels, 1, 1)."""
        last = self.counts.shape[1] - 1
        values = np.arange(last + 1) * self.unit
        total = self.counts.sum(1)
        mean = self.counts @ values / total
        spread = np.sqrt(np.maximum(self.counts @ values**2 / total - mean**2, 0.0))
        reached = np.cumsum(self.counts, axis=1)

        def shaped(numbers: Any) -> list[Any]:
            wrapped: list[Any] = np.asarray(numbers, float).reshape(-1, 1, 1).tolist()
            return wrapped

        told = {
            "min": shaped([values[np.argmax(row > 0)] for row in self.counts]),
            "max": shaped([values[last - np.argmax(row[::-1] > 0)] for row in self.counts]),
            "mean": shaped(mean),
            "std": shaped(spread),
            "count": [self.images],
        }
        for share in QUANTILES:
            at = [np.searchsorted(row, share / 100 * row[-1]) for row in reached]
            told[f"q{share:02d}"] = shaped([values[min(it, last)] for it in at])
        return told

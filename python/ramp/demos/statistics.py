"""Statistics of a data set's columns: least, largest, mean, standard deviation and quantiles."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

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


class Colours:
    """How often each value of each channel occurs in some images."""

    def __init__(self) -> None:
        self.counts = np.zeros((3, 256), np.int64)
        self.images = 0

    def add(self, images: NDArray[np.uint8]) -> None:
        """Counts images of shape (T, height, width, 3)."""
        for channel in range(3):
            self.counts[channel] += np.bincount(images[..., channel].ravel(), minlength=256)
        self.images += len(images)

    def __iadd__(self, other: Colours) -> Colours:
        self.counts += other.counts
        self.images += other.images
        return self

    def told(self) -> dict[str, list[Any]]:
        """The statistics of values from 0 to 1, shape (3, 1, 1)."""
        values = np.arange(256) / 255.0
        total = self.counts.sum(1)
        mean = self.counts @ values / total
        spread = np.sqrt(np.maximum(self.counts @ values**2 / total - mean**2, 0.0))
        reached = np.cumsum(self.counts, axis=1)

        def shaped(numbers: Any) -> list[Any]:
            wrapped: list[Any] = np.asarray(numbers, float).reshape(3, 1, 1).tolist()
            return wrapped

        told = {
            "min": shaped([values[np.argmax(row > 0)] for row in self.counts]),
            "max": shaped([values[255 - np.argmax(row[::-1] > 0)] for row in self.counts]),
            "mean": shaped(mean),
            "std": shaped(spread),
            "count": [self.images],
        }
        for share in QUANTILES:
            at = [np.searchsorted(row, share / 100 * row[-1]) for row in reached]
            told[f"q{share:02d}"] = shaped([values[min(it, 255)] for it in at])
        return told

"""A small convolutional network in NumPy: its output, its gradient, and steps of Adam.

Images pass through convolutions of 3 by 3 pixels in steps of two, each with a ramp function, and then, with
further numbers, through two dense layers.
"""

from __future__ import annotations

import pathlib
import zipfile
import zlib

import numpy as np
from numpy.typing import NDArray

from ramp._core import InputError

Floats = NDArray[np.float32]
Weights = list[Floats]
"""Of each layer the matrix, shape (inputs, outputs), and the offsets, shape (outputs,)."""

KERNEL = 3
"""Pixels along each side of a convolution."""


def initial(
    side: int, widths: tuple[int, ...], hidden: int, outputs: int, further: int, random: np.random.Generator
) -> Weights:
    """Random weights for square images with three colours.

    Args:
        side: Pixels along each side of an image.
        widths: Channels after each convolution.
        hidden: Numbers between the two dense layers.
        outputs: Numbers that the network gives.
        further: Numbers that join the last convolution.
        random: The source of the weights.

    """
    weights: Weights = []
    channels = 3
    for width in widths:
        weights += _layer(KERNEL * KERNEL * channels, width, random)
        side, channels = (side + 1) // 2, width
    weights += _layer(side * side * channels + further, hidden, random)
    weights += _layer(hidden, outputs, random)
    return weights


def _layer(inputs: int, outputs: int, random: np.random.Generator) -> Weights:
    matrix = random.standard_normal((inputs, outputs)) * np.sqrt(2.0 / inputs)
    return [matrix.astype(np.float32), np.zeros(outputs, np.float32)]


def save(file: str | pathlib.Path, weights: Weights) -> None:
    """Writes weights, with the precision of half floats."""
    named = {f"{index:02}": weight.astype(np.float16) for index, weight in enumerate(weights)}
    np.savez_compressed(file, **named)  # type: ignore[arg-type]


def load(file: str | pathlib.Path, like: Weights) -> Weights:
    """The weights of a file of :func:`save`.

    Raises `InputError` if it cannot be read, or if its layers have other shapes than those of ``like``.
    """
    names = [f"{index:02}" for index in range(len(like))]
    try:
        with zipfile.ZipFile(file) as told:
            large = max(entry.file_size for entry in told.infolist())
        # A half float has two bytes; 1 kB is more than the head of an array.
        if large > 2 * max(weight.size for weight in like) + 1024:
            raise InputError(f"{file}: its arrays are larger than those of these layers")
        with np.load(file, allow_pickle=False) as arrays:
            weights = [np.asarray(arrays[name]) for name in names]
    except InputError:
        raise
    except (OSError, ValueError, KeyError, EOFError, MemoryError, zipfile.BadZipFile, zlib.error) as error:
        raise InputError(f"{file} has no weights of a network: {error}") from None
    for name, weight, want in zip(names, weights, like, strict=True):
        if weight.shape != want.shape or weight.dtype != np.float16:
            found = f"{weight.dtype} of shape {weight.shape}"
            raise InputError(f"{file}: array {name} is {found}, expected float16 of shape {want.shape}")
        if not np.isfinite(weight).all():
            raise InputError(f"{file}: array {name} has a number that is not finite")
    return [weight.astype(np.float32) for weight in weights]


def output(weights: Weights, images: Floats, further: Floats) -> Floats:
    """What the network gives.

    Args:
        weights: As of :func:`initial`.
        images: Numbers of about one, shape (count, side, side, 3).
        further: Shape (count, numbers).

    """
    return _forward(weights, images, further)[0]


def error_and_gradient(weights: Weights, images: Floats, further: Floats, wanted: Floats) -> tuple[float, Weights]:
    """The mean absolute error of the outputs, and its gradient."""
    given, kept = _forward(weights, images, further)
    off = given - wanted
    return float(np.abs(off).mean()), _backward(weights, kept, np.sign(off) / np.float32(off.size))


Kept = list[tuple[Floats, Floats]]
"""The input and the output of each layer."""


def _forward(weights: Weights, images: Floats, further: Floats) -> tuple[Floats, Kept]:
    pairs, kept = _pairs(weights), Kept()
    for matrix, offset in pairs[:-2]:
        patches = _patches(images)
        images = np.maximum(patches.reshape(-1, len(matrix)) @ matrix + offset, 0.0)
        images = images.reshape(*patches.shape[:3], len(offset))
        kept.append((patches, images))
    rows = np.concatenate([images.reshape(len(images), -1), further], axis=1)
    middle = np.maximum(rows @ pairs[-2][0] + pairs[-2][1], 0.0)
    given = middle @ pairs[-1][0] + pairs[-1][1]
    kept += [(rows, middle), (middle, given)]
    return given, kept


def _backward(weights: Weights, kept: Kept, slope: Floats) -> Weights:
    pairs = _pairs(weights)
    (rows, middle), _ = kept[-2:]
    last = [middle.T @ slope, slope.sum(0)]
    slope = slope @ pairs[-1][0].T * (middle > 0.0)
    gradients = [rows.T @ slope, slope.sum(0), *last]
    images = kept[-3][1]
    slope = (slope @ pairs[-2][0].T)[:, : images[0].size].reshape(images.shape)
    for index in range(len(pairs) - 3, -1, -1):
        patches, images = kept[index]
        flat = (slope * (images > 0.0)).reshape(-1, images.shape[-1])
        gradients[:0] = [patches.reshape(len(flat), -1).T @ flat, flat.sum(0)]
        if index > 0:
            side = kept[index - 1][1].shape[1]
            slope = _unpatched((flat @ pairs[index][0].T).reshape(patches.shape))[:, :side, :side]
    return gradients


def _pairs(weights: Weights) -> list[tuple[Floats, Floats]]:
    return list(zip(weights[0::2], weights[1::2], strict=True))


def _patches(images: Floats) -> Floats:
    """The surroundings of every second pixel, (count, half, half, 9 * channels); beyond the edge is zero."""
    count, side, _, channels = images.shape
    half = (side + 1) // 2
    wide = np.zeros((count, 2 * half + 1, 2 * half + 1, channels), images.dtype)
    wide[:, 1 : side + 1, 1 : side + 1] = images
    patches = np.empty((count, half, half, KERNEL, KERNEL, channels), images.dtype)
    for y in range(KERNEL):
        for x in range(KERNEL):
            patches[:, :, :, y, x] = wide[:, y : y + 2 * half : 2, x : x + 2 * half : 2]
    return patches.reshape(count, half, half, -1)


def _unpatched(slope: Floats) -> Floats:
    """What each pixel has in all patches together, shape (count, 2 * half, 2 * half, channels)."""
    count, half = slope.shape[:2]
    parts = slope.reshape(count, half, half, KERNEL, KERNEL, -1)
    wide = np.zeros((count, 2 * half + 1, 2 * half + 1, parts.shape[-1]), slope.dtype)
    for y in range(KERNEL):
        for x in range(KERNEL):
            wide[:, y : y + 2 * half : 2, x : x + 2 * half : 2] += parts[:, :, :, y, x]
    return wide[:, 1:, 1:]


class Adam:
    """Changes weights in place, against averages of their gradients."""

    def __init__(self, weights: Weights) -> None:
        self.weights = weights
        self.mean = [np.zeros_like(each) for each in weights]
        self.square = [np.zeros_like(each) for each in weights]
        self.steps = 0

    def step(self, gradients: Weights, rate: float) -> None:
        """One step of about ``rate`` for each weight."""
        self.steps += 1
        first, second = 1.0 - 0.9**self.steps, 1.0 - 0.999**self.steps
        for weight, mean, square, slope in zip(self.weights, self.mean, self.square, gradients, strict=True):
            mean *= 0.9
            mean += 0.1 * slope
            square *= 0.999
            square += 0.001 * slope * slope
            weight -= np.float32(rate / first) * mean / (np.sqrt(square / np.float32(second)) + np.float32(1e-8))

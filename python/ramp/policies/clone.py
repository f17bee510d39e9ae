"""A policy for `fasten` from images and forces to motion, cloned from demonstrations.

One network sees what a wrist camera and the force show, and where the hole is believed to be; it gives the
next actions. Nothing in it computes where the hole is. It needs numpy alone; training reads a data set of
`ramp demos` in zarr.

    ramp demos fasten --goal easy-1 easy-2 medium-1 medium-3 hard-1 hard-3 --episodes 200 --image-size 128 \
        --format zarr -o demos/clone
    python -m ramp.policies.clone demos/clone -o clone.npz
    python -m ramp.policies.judge --clone clone.npz --policies "cloned policy" --worlds real --errors 2
"""

from __future__ import annotations

import argparse
import dataclasses
import pathlib
import time

import numpy as np
from numpy.typing import NDArray

from ramp._core import InputError
from ramp.policies import convolution, fasten, localise
from ramp.policies.convolution import Floats, Weights
from ramp.policies.fasten import Array, Rows

WEIGHTS = pathlib.Path(__file__).with_name("clone.npz")
CHUNK = 4
"""Actions that the network gives at once."""
HIDDEN = 64
"""Numbers between the dense layers."""
SENSES = 12
"""Numbers that join the image."""
OUTPUTS = 3 * CHUNK
MIRRORED = np.array([1, -1, 1, 1, 1, -1, 1, -1, 1, 1, -1, 1], np.float32)
"""The signs of the senses in a mirror that changes the side of the hand's y axis; a torque about x changes its own."""
MIRRORED_ACTION = np.tile(np.array([1, -1, 1], np.float32), CHUNK)
ENVIRONMENT = "RAMP/Fasten-v0"
"""Whose demonstrations it takes."""


def senses(error: Array, felt: Array, lead: Array, yaw: Array) -> Floats:
    """What joins the image, as numbers of about one, along the axes of the hand, shape (count, SENSES).

    Args:
        error: The believed way from the peg to its place, axes of the world, m, shape (count, 3 or more).
        felt: Force and horizontal torque, axes of the world, N and N·m, shape (count, 5).
        lead: The way from the tip to its target, axes of the world, m, shape (count, 3 or more).
        yaw: The angle of the hand about z of the world, rad, shape (count,).

    """
    over = -error[:, 2:3] - fasten.STEM
    flat = [localise.turned(each, -yaw) for each in (error[:, :2], felt[:, :2], felt[:, 3:5], lead[:, :2])]
    leash = np.array(fasten.SETTINGS["leash"])
    numbers = [
        np.clip(flat[0] / 3e-3, -3.0, 3.0),
        np.clip(over / 1e-2, -3.5, 1.0),
        np.tanh(over / 1.5e-3),
        np.clip(np.concatenate([flat[1] / 10.0, felt[:, 2:3] / 10.0, flat[2] / 0.5], axis=1), -4.0, 4.0),
        flat[3] / leash[:2],
        lead[:, 2:3] / leash[2],
    ]
    return np.concatenate(numbers, axis=1).astype(np.float32)


def smoothed(felt: Array | None, wrench: Array) -> Array:
    """Force and horizontal torque, each half new and half of what was felt before."""
    new = np.asarray(wrench, float)[:, :5]
    return new if felt is None else 0.5 * (felt + new)


def initial(random: np.random.Generator) -> Weights:
    """Random weights."""
    return convolution.initial(localise.SIDE, localise.WIDTHS, HIDDEN, OUTPUTS, SENSES, random)


def load(file: str | pathlib.Path = WEIGHTS) -> Weights:
    """The weights that come with the package, or those of a file. Raises `InputError` if it has none."""
    return convolution.load(file, initial(np.random.default_rng(0)))


class Clone:
    """The policy at work, for :func:`ramp.policies.fasten.episodes`. Rows are environments.

    ``aim`` takes in observations, with the field ``wrist`` of ``localise.IMAGE`` pixels; ``policy`` then
    gives the actions for them.
    """

    def __init__(self, weights: Weights) -> None:
        self.weights = weights
        self.felt: Array | None = None
        self.chunks: list[Array] = []
        self.action: Array | None = None

    def aim(self, seen: Rows) -> Rows:
        """Computes the actions for observations; they are left as they are."""
        yaw = localise.yaw(seen["tip"])
        self.felt = smoothed(self.felt, seen["wrench"])
        further = senses(np.asarray(seen["error"], float), self.felt, np.asarray(seen["lead"], float), yaw)
        images = localise.scaled(localise.cut(seen["wrist"]).astype(np.float32))
        given = convolution.output(self.weights, images, further).astype(float).reshape(-1, CHUNK, 3)
        self.chunks = [given, *self.chunks[: CHUNK - 1]]
        # What the last calls say of this moment, together.
        action = np.mean([chunk[:, age] for age, chunk in enumerate(self.chunks)], axis=0)
        action[:, :2] = localise.turned(action[:, :2], yaw)
        self.action = np.clip(action, -1.0, 1.0)
        return seen

    def policy(self, features: Array) -> Array:
        """The actions for the observations that ``aim`` took in; ``features`` are not used."""
        if self.action is None:
            raise ValueError("`aim` has taken in no observation")
        return self.action


@dataclasses.dataclass
class Demonstrations:
    """Steps of successful episodes."""

    images: localise.Images
    """Whole images, shape (count, IMAGE, IMAGE, 3)."""
    error: Array
    """The believed ways from peg to place, m, shape (count, 3)."""
    felt: Array
    """As of :func:`smoothed`."""
    lead: Array
    """Ways from the tip to its target, m, shape (count, 3)."""
    yaw: Array
    """Angles of the hand, rad."""
    wanted: Floats
    """The next actions, along the axes of the hand, shape (count, OUTPUTS)."""
    episode: NDArray[np.intp]
    """The number of the episode of each step."""


def demonstrations(folder: str | pathlib.Path) -> Demonstrations:
    """The successful episodes of a data set of `ramp demos`.

    Raises `InputError` if it is not one of `fasten` in zarr with images of ``localise.IMAGE`` pixels.
    """
    from ramp.demos import formats
    from ramp.demos.collect import read_meta
    from ramp.demos.zarr_buffer import read

    folder = pathlib.Path(folder)
    told = read_meta(folder)
    asked = {"format": "zarr", "environment": ENVIRONMENT, "rate": round(fasten.RATE), "image_size": localise.IMAGE}
    for name, want in asked.items():
        if told.get(name) != want:
            raise InputError(f"{folder}: its {name} is {told.get(name)!r}, expected {want!r}")
    formats.need("zarr")
    width = {"error": 6, "wrench": 6, "lead": 6, "tip": 7, "action": 3}
    shapes: dict[str, tuple[int, ...]] = {name: (count,) for name, count in width.items()}
    rows, ends, success = read(folder, shapes | {"wrist_image": (localise.IMAGE, localise.IMAGE, 3)})
    firsts = [0, *ends[:-1]]
    good = [pair for pair, won in zip(zip(firsts, ends, strict=True), success, strict=True) if won]
    if not good:
        raise InputError(f"{folder}: no episode is successful")
    felt, wanted = [], []
    for first, end in good:
        last: Array | None = None
        for wrench in rows["wrench"][first:end]:
            last = smoothed(last, wrench[None])
            felt.append(last)
        actions, yaw = rows["action"][first:end].astype(float), localise.yaw(rows["tip"][first:end])
        steps = np.minimum(np.arange(end - first)[:, None] + np.arange(CHUNK), end - first - 1)
        next_ones = actions[steps]
        for number in range(CHUNK):
            next_ones[:, number, :2] = localise.turned(next_ones[:, number, :2], -yaw)
        wanted.append(next_ones.reshape(-1, OUTPUTS))
    use = np.concatenate([np.arange(first, end) for first, end in good])
    return Demonstrations(
        images=rows["wrist_image"][use],
        error=rows["error"][use, :3].astype(float),
        felt=np.concatenate(felt),
        lead=rows["lead"][use, :3].astype(float),
        yaw=localise.yaw(rows["tip"][use]),
        wanted=np.concatenate(wanted).astype(np.float32),
        episode=np.concatenate([np.full(end - first, number) for number, (first, end) in enumerate(good)]),
    )


@dataclasses.dataclass(frozen=True)
class Training:
    """How the network learns."""

    epochs: int = 30
    batch: int = 64
    rate: float = 2.0e-3
    """Of Adam, at first."""
    belief: float = 3.0e-3
    """Error of the believed hole along x and along y, m: one for each episode and pass, and a fifth of it along z.

    The demonstrator knows the hole, and its actions stay as they are.
    """
    images: localise.Training = localise.Training()
    """How images vary."""


def train(shown: Demonstrations, seed: int = 0, how: Training = Training()) -> Weights:  # noqa: B008
    """Teaches a network: Adam on the mean absolute error of actions. The same seed gives the same weights."""
    random = np.random.default_rng(seed)
    weights = initial(random)
    adam = convolution.Adam(weights)
    count, start = len(shown.wanted), time.process_time()
    batches = max(count // how.batch, 1)
    for epoch in range(how.epochs):
        order, errors = random.permutation(count), []
        off = random.normal(0.0, how.belief, (int(shown.episode.max()) + 1, 3)) * (1.0, 1.0, 0.2)
        for number in range(batches):
            chosen = order[number * how.batch : (number + 1) * how.batch]
            error = shown.error[chosen] + off[shown.episode[chosen]]
            further = senses(error, shown.felt[chosen], shown.lead[chosen], shown.yaw[chosen])
            images, wanted = localise.varied(shown.images[chosen], how.images, random), shown.wanted[chosen]
            images = localise.scaled(images)
            # The hand and its camera are the same on both sides.
            mirrored = random.random(len(chosen)) < 0.5
            images[mirrored] = images[mirrored, :, ::-1]
            further[mirrored] *= MIRRORED
            wanted[mirrored] *= MIRRORED_ACTION
            wrong, gradients = convolution.error_and_gradient(weights, images, further, wanted)
            left = 1.0 - (epoch + number / batches) / how.epochs
            adam.step(gradients, how.rate * min(1.0, 2.0 * left + 0.01))
            errors.append(wrong)
        if epoch % 5 == 4 or epoch + 1 == how.epochs:
            spent = time.process_time() - start
            print(f"epoch {epoch + 1}  mean error {np.mean(errors):.3f}  CPU {spent:.0f} s", flush=True)
    return weights


def main() -> None:
    """Trains, as the command line says."""
    parser = argparse.ArgumentParser(description="Clones a policy for `fasten` from demonstrations.")
    parser.add_argument("demonstrations", help="folder of `ramp demos fasten --format zarr --image-size 128`")
    parser.add_argument("-o", "--output", default="clone.npz")
    parser.add_argument("--epochs", type=int, default=Training.epochs)
    parser.add_argument("--seed", type=int, default=0)
    told = parser.parse_args()
    try:
        shown = demonstrations(told.demonstrations)
    except InputError as error:
        parser.error(str(error))
    print(f"{len(shown.wanted)} steps of {shown.episode.max() + 1} episodes", flush=True)
    convolution.save(told.output, train(shown, told.seed, Training(epochs=told.epochs)))


if __name__ == "__main__":
    main()

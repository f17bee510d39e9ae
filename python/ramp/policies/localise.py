"""Finds the hole under a held peg in an image of the wrist camera.

A small network looks at a part of the image, and tells the way from the peg to the hole in the hand's frame.
It needs numpy alone; to train it needs the environments, too.

    python -m ramp.policies.localise train -o localise.npz     images from the twin, and training
    python -m ramp.policies.localise judge localise.npz        errors on images of goals that it never saw
"""

from __future__ import annotations

import argparse
import dataclasses
import pathlib
import subprocess
import sys
import tempfile
import time

import numpy as np
from numpy.typing import NDArray

from ramp.policies import convolution
from ramp.policies.convolution import Weights

Array = NDArray[np.float64]
Images = NDArray[np.uint8]

IMAGE = 128
"""Rows of the whole image of the wrist camera, pixels."""
SIDE = 96
"""Of the part that the network sees, pixels: in the middle of the lower edge, where hand, peg and hole are."""
LOOK = 410
"""Pixels in a row of an image that ``robot.look`` is asked for: two by two of its pixels make one of the network's."""
WEIGHTS = pathlib.Path(__file__).with_name("localise.npz")
WIDTHS = (8, 16, 24, 32)
"""Channels after each convolution."""
HIDDEN = 56
"""Numbers between the dense layers."""
OVER = 35.2e-3
"""From this height of the peg above its place on, m, its tip is over the plate and the hole in sight."""

TRAINING = ("easy-1", "easy-2", "medium-1", "medium-3", "hard-1", "hard-3")
"""Goals whose images teach the network."""
GENERATED = ((4, "medium"), (6, "medium"), (5, "hard"), (7, "hard"))
"""Beams and classes of further goals for training, which show joints from more sides: three of each are generated."""
GENERATING_SEED = 7
UNSEEN = ("easy-3", "medium-2", "hard-2")
"""Goals that are kept for judging."""
OWN_STARTS, FURTHER_STARTS = (1, 120), (1001, 90)
"""First seed and number of the starts for training: on the goals of the package, and on those with generated ones."""
OWN_EPISODES, FURTHER_EPISODES = 144, 120
"""Episodes on them in each world, which give about 19 images each."""
FIRST_JUDGING_START = 100_001


def cut(images: Images) -> Images:
    """What the network sees of images of shape (..., IMAGE, IMAGE, 3)."""
    beside = (IMAGE - SIDE) // 2
    return np.asarray(images[..., IMAGE - SIDE :, beside : beside + SIDE, :])


def shrink(pixels: Images) -> Images:
    """What the network sees of an image that ``robot.look`` gave with the size ``LOOK``."""
    side = 2 * SIDE
    row, column = 2 * IMAGE - side, (LOOK - side) // 2
    part = pixels[row : row + side, column : column + side].astype(np.uint16)
    return np.asarray(part.reshape(SIDE, 2, SIDE, 2, 3).sum((1, 3)) // 4, np.uint8)


def initial(random: np.random.Generator) -> Weights:
    """Random weights."""
    return convolution.initial(SIDE, WIDTHS, HIDDEN, 2, 1, random)


def load(file: str | pathlib.Path = WEIGHTS) -> Weights:
    """The weights that come with the package, or those of a file. Raises `InputError` if it has none."""
    return convolution.load(file, initial(np.random.default_rng(0)))


def locate(weights: Weights, images: Images, heights: Array, tips: Array) -> Array:
    """From peg to hole along x and y of the world, m, shape (count, 2).

    Args:
        weights: As of :func:`load`.
        images: What :func:`cut` or :func:`shrink` gives, shape (count, SIDE, SIDE, 3).
        heights: Of the peg above its place as it is believed, m, shape (count,).
        tips: Poses of the tip, shape (count, 7): x, y, z, quaternion w, x, y, z.

    """
    found = convolution.output(weights, scaled(images.astype(np.float32)), _further(heights))
    return np.asarray(turned(found.astype(float) * 1e-3, yaw(tips)))


def scaled(images: NDArray[np.float32]) -> NDArray[np.float32]:
    """Images as the networks take them: numbers of about one."""
    return np.asarray(images / np.float32(255.0) - np.float32(0.4))


def _further(heights: Array) -> NDArray[np.float32]:
    return ((np.asarray(heights) - 0.04) / 0.005)[:, None].astype(np.float32)


def yaw(tips: Array) -> Array:
    """The angle of the hand's x axis about z of the world, rad."""
    w, x, y, z = np.asarray(tips, float)[:, 3:].T
    return np.asarray(np.arctan2(2.0 * (x * y + w * z), 1.0 - 2.0 * (y * y + z * z)))


def turned(vectors: Array, angles: Array) -> Array:
    """Vectors in the plane turned by angles."""
    cos, sin = np.cos(angles), np.sin(angles)
    x, y = vectors.T
    return np.stack([cos * x - sin * y, sin * x + cos * y], axis=1)


@dataclasses.dataclass
class Examples:
    """Images with the places of the holes in them."""

    images: Images
    """Whole images, shape (count, IMAGE, IMAGE, 3)."""
    heights: Array
    """Of the peg above its place as it is believed, m."""
    tips: Array
    """Poses of the tip, shape (count, 7)."""
    offsets: Array
    """True ways from peg to hole along x and y of the world, m, shape (count, 2)."""

    @staticmethod
    def together(parts: list[Examples]) -> Examples:
        """All examples of several."""
        names = [field.name for field in dataclasses.fields(Examples)]
        return Examples(*(np.concatenate([getattr(part, name) for part in parts]) for name in names))


@dataclasses.dataclass(frozen=True)
class Collection:
    """How images are collected: the hand moves about over the hole."""

    envs: int = 12
    steps: int = 40
    """Actions of an episode; every second one gives an image."""
    change: int = 5
    """Actions until the hand heads elsewhere."""
    near: float = 2.0e-3
    """Of half of the places that it heads for, the standard deviation about the hole, m."""
    far: float = 14.0e-3
    """And of the others the largest distance along each axis, m."""
    heights: tuple[float, float] = (36.0e-3, 46.0e-3)
    """Of the peg above its place, m."""
    speed: float = 0.1
    """Of the hand, m/s."""
    leash: float = 0.02
    """Of the impedance's target, m."""


def collect(
    world: str,
    goals: tuple[str, ...],
    starts: tuple[int, int],
    episodes: int,
    seed: int,
    how: Collection = Collection(),  # noqa: B008
) -> Examples:
    """Images over the holes of goals in a world, with the twin's truth for a label.

    Args:
        world: The physics.
        goals: Goals whose steps are drawn.
        starts: First seed and number of the starts.
        episodes: Number of episodes; a multiple of ``how.envs``.
        seed: Of the episodes and of the motions in them.
        how: How the hand moves.

    """
    from ramp.gym import RampVectorEnv

    rate = 20.0
    env = RampVectorEnv(
        how.envs, "fasten", goals=goals, track="noisy", world=world, starts=starts, truth=True, gripper=False,
        turns=False, speed=how.speed, leash=[how.leash] * 3, rate=rate, limit=how.steps / rate + 1.0,
        autoreset_mode="DISABLED", cameras=("wrist",), image_size=IMAGE,
    )  # fmt: skip
    env.prepare()
    random = np.random.default_rng(seed)
    parts: list[Examples] = []
    for first in range(0, episodes, how.envs):
        seen, _ = env.reset(seed=[1_000_000 * seed + first + index for index in range(how.envs)])
        over = np.zeros(how.envs, bool)
        true, heading = -seen["error"][:, :3].astype(float), np.zeros((how.envs, 3))
        for step in range(how.steps):
            if step % how.change == 0:
                heading = _headings(how, random)
            action = np.clip((heading - true) * rate / how.speed, -1.0, 1.0)
            seen, _, terminated, truncated, told = env.step(action.astype(np.float32))
            over |= terminated | truncated
            true = told["truth"]["off"].astype(float)
            height = -seen["error"][:, 2].astype(float)
            use = ~over & (height > OVER)
            if step % 2 == 1:
                tips = seen["tip"][use].astype(float)
                parts.append(Examples(seen["wrist"][use], height[use], tips, -true[use, :2]))
    return Examples.together(parts)


def _headings(how: Collection, random: np.random.Generator) -> Array:
    """Where the hands head for, from the holes, m, shape (envs, 3)."""
    near = random.normal(0.0, how.near, (how.envs, 2))
    far = random.uniform(-how.far, how.far, (how.envs, 2))
    beside = np.where(random.random((how.envs, 1)) < 0.5, near, far)
    return np.concatenate([beside, random.uniform(*how.heights, (how.envs, 1))], axis=1)


@dataclasses.dataclass(frozen=True)
class Training:
    """How the network learns, and how the images are changed, so that it bears what a real camera does."""

    epochs: int = 14
    batch: int = 64
    rate: float = 2.0e-3
    """Of Adam, at first."""
    light: float = 0.25
    """Largest change of the brightness, as a share."""
    noise: float = 5.0
    """Standard deviation of a pixel, of 255."""
    shift: float = 0.8
    """Of the whole image, pixels: an error of the camera's calibration."""
    height: float = 0.5e-3
    """Of the believed height, m."""
    hidden: int = 28
    """Side of a grey square in some images, pixels, so that no single mark tells the place alone."""
    grey: float = 0.5
    """Share of these images."""


def train(examples: Examples, seed: int = 0, how: Training = Training()) -> Weights:  # noqa: B008
    """Teaches a network: Adam on the mean absolute error in mm. The same seed gives the same weights."""
    random = np.random.default_rng(seed)
    weights = initial(random)
    adam = convolution.Adam(weights)
    wanted = (1e3 * turned(examples.offsets, -yaw(examples.tips))).astype(np.float32)
    count, start = len(wanted), time.process_time()
    batches = count // how.batch
    for epoch in range(how.epochs):
        order, errors = random.permutation(count), []
        for number in range(batches):
            chosen = order[number * how.batch : (number + 1) * how.batch]
            images, goal = scaled(varied(examples.images[chosen], how, random)), wanted[chosen]
            # The hand and its camera are the same on both sides.
            mirrored = random.random(how.batch) < 0.5
            images[mirrored], goal[mirrored, 1] = images[mirrored, :, ::-1], -goal[mirrored, 1]
            further = _further(examples.heights[chosen] + random.normal(0.0, how.height, how.batch))
            error, gradients = convolution.error_and_gradient(weights, images, further, goal)
            left = 1.0 - (epoch + number / batches) / how.epochs
            adam.step(gradients, how.rate * min(1.0, 2.0 * left + 0.01))
            errors.append(error)
        if epoch % 5 == 4 or epoch + 1 == how.epochs:
            spent = time.process_time() - start
            print(f"epoch {epoch + 1}  mean error {np.mean(errors):.3f} mm  CPU {spent:.0f} s", flush=True)
    return weights


def varied(images: Images, how: Training, random: np.random.Generator) -> NDArray[np.float32]:
    """What the network would see of images by a camera whose light, noise and calibration differ."""
    count = len(images)
    beside, edge = (IMAGE - SIDE) // 2, 4
    wide = np.pad(images[:, IMAGE - SIDE - edge :], ((0, 0), (0, edge), (0, 0), (0, 0)), "edge").astype(np.float32)
    shifts = np.clip(random.normal(0.0, how.shift, (count, 2)), -edge + 1, edge - 1) + edge
    changed = np.empty((count, SIDE, SIDE, 3), np.float32)
    for index, shift in enumerate(shifts):
        (row, column), (down, right) = shift.astype(int), (shift % 1.0).astype(np.float32)
        column += beside - edge
        part = wide[index, row : row + SIDE + 1, column : column + SIDE + 1]
        part = part[:-1] + down * (part[1:] - part[:-1])
        changed[index] = part[:, :-1] + right * (part[:, 1:] - part[:, :-1])
    corners = random.integers(0, SIDE - how.hidden, (count, 2))
    for grey in np.flatnonzero(random.random(count) < how.grey):
        row, column = corners[grey].tolist()
        changed[grey, row : row + how.hidden, column : column + how.hidden] = random.uniform(40.0, 180.0)
    changed *= random.uniform(1.0 - how.light, 1.0 + how.light, (count, 1, 1, 1)).astype(np.float32)
    changed += np.float32(how.noise) * random.standard_normal(changed.shape, np.float32)
    return np.clip(changed, 0.0, 255.0)


def errors(weights: Weights, examples: Examples) -> Array:
    """Distances between where the holes are and where the network finds them, m."""
    found = locate(weights, cut(examples.images), examples.heights, examples.tips)
    return np.asarray(np.hypot(*(found - examples.offsets).T))


def generated(folder: str) -> tuple[str, ...]:
    """Writes the further goals for training into a folder, and gives their files."""
    for beams, kind in GENERATED:
        numbers = ["--beams", str(beams), "--class", kind, "--seed", str(GENERATING_SEED), "--count", "3"]
        command = [sys.executable, "-m", "ramp", "goals", "generate", *numbers, "-o", folder]
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    return tuple(str(file) for file in sorted(pathlib.Path(folder).glob("*.xml")))


def _judge(weights: Weights, worlds: tuple[str, ...], goals: tuple[str, ...]) -> None:
    """Tells the errors on images of goals and starts, by world and goal."""
    print(f"judges on {', '.join(goals)}, starts from {FIRST_JUDGING_START} on", flush=True)
    for world in worlds:
        for goal in goals:
            off = 1e3 * errors(weights, collect(world, (goal,), (FIRST_JUDGING_START, 12), 12, 9))
            shares = "  ".join(f"{share:.0%} {np.quantile(off, share):.2f}" for share in (0.5, 0.9, 0.99))
            print(f"{world}, {goal}: {len(off)} images, error in mm: {shares}", flush=True)


def main() -> None:
    """Trains or judges, as the command line says."""
    parser = argparse.ArgumentParser(description="Finds the hole under a peg in an image of the wrist camera.")
    parser.add_argument("task", choices=["train", "judge"])
    parser.add_argument("weights", nargs="?", default=str(WEIGHTS), help="to be judged")
    parser.add_argument("-o", "--output", default="localise.npz")
    parser.add_argument("--worlds", default="real,ideal")
    parser.add_argument("--goals", help="to train on, or to judge on: names or files; default: those of the package")
    parser.add_argument("--epochs", type=int, default=Training.epochs)
    parser.add_argument("--seed", type=int, default=0)
    told = parser.parse_args()
    worlds, goals = tuple(told.worlds.split(",")), tuple(told.goals.split(",")) if told.goals else None
    if told.task == "judge":
        _judge(load(told.weights), worlds, goals or UNSEEN)
        return
    learned, begin, seed = goals or TRAINING, time.process_time(), told.seed
    print(f"trains on {', '.join(learned)}, starts {_range(OWN_STARTS)}", flush=True)
    made = [collect(world, learned, OWN_STARTS, OWN_EPISODES, seed + 1) for world in worlds]
    if goals is None:
        with tempfile.TemporaryDirectory() as folder:
            further = generated(folder)
            print(f"and with {len(further)} generated goals, starts {_range(FURTHER_STARTS)}", flush=True)
            both = learned + further
            made += [collect(world, both, FURTHER_STARTS, FURTHER_EPISODES, seed + 11) for world in worlds]
    examples = Examples.together(made)
    print(f"{len(examples.heights)} images, CPU {time.process_time() - begin:.0f} s", flush=True)
    convolution.save(told.output, train(examples, seed, Training(epochs=told.epochs)))
    _judge(load(told.output), worlds, tuple(goal for goal in UNSEEN if goal not in learned))


def _range(starts: tuple[int, int]) -> str:
    return f"{starts[0]} to {sum(starts) - 1}"


if __name__ == "__main__":
    main()

"""The digital twin, to be driven step by step."""

from __future__ import annotations

import os
from types import TracebackType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ramp._core import CameraImage, Command, CompiledTwin, Observation, Snapshot, benchmark
from ramp.goal import Goal, as_goal

Array = NDArray[np.float64]


class Twin:
    """The world of an episode: the arm at home, the parts on the sheet, all physics from the seed.

    >>> with ramp.Twin("easy-1") as twin:
    ...     seen = twin.observe()
    ...     seen = twin.step(ramp.Command.joint_positions(seen.positions), periods=100)
    ...     round(seen.time, 3)
    0.1
    """

    def __init__(
        self,
        goal: str | os.PathLike[str] | Goal = "easy-1",
        *,
        track: str = "state",
        world: str | os.PathLike[str] = "real",
        start: str | os.PathLike[str] = "moved",
        seed: int = 1,
        fault: str | None = None,
    ) -> None:
        """Builds the scene.

        Args:
            goal: A goal of the benchmark, a goal file, or a goal.
            track: What :meth:`read_parts` and :meth:`look` give: ``state``, ``noisy``, ``tags``,
                ``colour`` or ``depth``.
            world: What the physics are drawn from: ``ideal``, ``real``, ``hard``, or a world file.
            start: Where the parts lie: ``moved``, ``sheet``, ``scattered``, ``jumbled``, or a start file.
            seed: All randomness flows from it.
            fault: What goes wrong on purpose, as ``KIND`` or ``KIND@N`` of ``ramp run --fault``.

        """
        self._goal = as_goal(goal)
        world, start = os.fspath(world), os.fspath(start)
        self._arguments: dict[str, Any] = {
            "track": track, "world": world, "start": start, "seed": seed, "fault": fault,
        }  # fmt: skip
        self._twin = CompiledTwin(benchmark(), self._goal.source, track, world, start, seed, fault)

    def __enter__(self) -> Twin:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        return None

    def __reduce__(self) -> tuple[Any, ...]:
        """A twin that is pickled or copied is one at its start: the state does not go with it."""
        return (_twin, (self._goal, self._arguments))

    @property
    def goal(self) -> Goal:
        """The goal."""
        return self._goal

    @property
    def time(self) -> float:
        """Robot time, s."""
        return self._twin.time

    def step(self, command: Command, periods: int = 1) -> Observation:
        """Lets ``periods`` control periods of 1 ms pass under a command; what is sensed after the last.

        Raises:
            ramp.RobotStopped: A limit of the arm was broken. Every further call raises it again.
            ramp.Recovered: The arm stopped, stood for a while and is ready again. A new motion begins
                where it is.

        """
        return self._twin.step(command, periods)

    def observe(self) -> Observation:
        """What was sensed last, without letting time pass."""
        return self._twin.observe()

    def read_parts(self) -> dict[str, Array]:
        """Where the parts are, as far as the track tells: name to pose, shape (7,)."""
        return self._twin.read_parts()

    def expose(self) -> None:
        """Opens the shutters of both cameras without robot time: :meth:`look` gives the images later."""
        self._twin.expose()

    def look(self, camera: str = "wrist", *, size: int | None = None) -> CameraImage:
        """An image of a camera, ``wrist`` or ``birds-eye``: the oldest exposed and not taken, or a new one.

        Exposure and the way to the agent take robot time.

        Args:
            camera: Which camera.
            size: Pixels in a row, 16 to 1280, for an image of the whole field of view that is drawn in this
                size at once, which takes less time than a full one. Each pixel is one sample. None: 1280 by
                800.

        >>> ramp.Twin("easy-1", track="tags").look("birds-eye", size=64).pixels.shape
        (40, 64, 3)

        """
        return self._twin.look(camera, size)

    def snapshot(self) -> Snapshot:
        """The whole state, for :meth:`restore`: what follows is the same to the last bit."""
        return self._twin.snapshot()

    def restore(self, snapshot: Snapshot) -> None:
        """Goes back to a snapshot of this twin."""
        self._twin.restore(snapshot)

    def render(self, camera: str = "birds-eye", size: int = 256) -> NDArray[np.uint8]:
        """A picture for a person, shape (size, size, 3): no time passes. ``size`` is 16 to 512 pixels."""
        return self._twin.render(camera, size)

    def true_poses(self) -> dict[str, Array]:
        """Where everything really is: name to pose, shape (7,). Never for an agent that is judged."""
        return self._twin.true_poses()

    def pegs(self) -> dict[str, str | None]:
        """The peg that pins each connection now, by the referee's rule."""
        return self._twin.pegs()

    @property
    def scene(self) -> str:
        """The scene as MJCF, which MuJoCo 3.13 or newer loads."""
        return self._twin.scene

    @property
    def qpos(self) -> Array:
        """MuJoCo's positions: joints of the arm, fingers, all parts."""
        return self._twin.qpos

    @property
    def ctrl(self) -> Array:
        """MuJoCo's actuator commands of the last step."""
        return self._twin.ctrl

    @property
    def state_hash(self) -> str:
        """The same in two twins only if every bit of their physics is."""
        return self._twin.state_hash

    @property
    def largest_force(self) -> float:
        """The largest force at the wrist so far, N."""
        return self._twin.largest_force

    @property
    def deepest_penetration(self) -> float:
        """The deepest penetration of two parts so far, m."""
        return self._twin.deepest_penetration

    def __repr__(self) -> str:
        return f"Twin({self._goal.name!r}, seed={self._arguments['seed']}, time={self.time:.3f})"


def _twin(goal: Goal, arguments: dict[str, Any]) -> Twin:
    return Twin(goal, **arguments)

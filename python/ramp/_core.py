"""Loads the compiled module, and knows the folder of the data."""

from __future__ import annotations

import functools
import operator
import os
import pathlib
import sys
from typing import SupportsIndex

# Another libmujoco of this process, such as that of the package `mujoco`, must not take the place of our own.
if hasattr(sys, "setdlopenflags"):
    _flags = sys.getdlopenflags()
    sys.setdlopenflags(os.RTLD_NOW | getattr(os, "RTLD_DEEPBIND", 0))
try:
    from ramp._ramp import (
        Batch,
        Benchmark,
        CameraImage,
        Command,
        Driver,
        Env,
        EpisodePictures,
        InputError,
        Observation,
        PlanningError,
        Recovered,
        Refused,
        Robot,
        RobotStopped,
        Snapshot,
        __version__,
        check_event,
        current_result,
        curve_svg,
        describe_event,
        log_facts,
        play_log,
        view_lens,
    )
    from ramp._ramp import Twin as CompiledTwin
    from ramp._ramp import run as run_episode
finally:
    if hasattr(sys, "setdlopenflags"):
        sys.setdlopenflags(_flags)

__all__ = [
    "Batch",
    "Benchmark",
    "CameraImage",
    "Command",
    "CompiledTwin",
    "Driver",
    "Env",
    "EpisodePictures",
    "InputError",
    "Observation",
    "PlanningError",
    "Recovered",
    "Refused",
    "Robot",
    "RobotStopped",
    "Snapshot",
    "__version__",
    "benchmark",
    "check_event",
    "current_result",
    "curve_svg",
    "data",
    "describe_event",
    "log_facts",
    "integer",
    "play_log",
    "run_episode",
    "view_lens",
]

MAX_SEED = 2**64 - 1
"""The largest seed."""


def integer(name: str, value: SupportsIndex, least: int, most: int) -> int:
    """The integer that the argument `name` was given, if it is within its limits."""
    number = operator.index(value)
    if not least <= number <= most:
        raise InputError(f"{name}: found {number}, expected an integer from {least} to {most}")
    return number


def data() -> pathlib.Path:
    """The folder of kit, goals, rules, arm, worlds and starts; ``RAMP_DATA`` names another one."""
    return pathlib.Path(os.environ.get("RAMP_DATA") or pathlib.Path(__file__).parent / "data").resolve()


@functools.lru_cache(maxsize=8)
def _read(folder: str) -> Benchmark:
    return Benchmark(folder)


def benchmark() -> Benchmark:
    """The files of :func:`data`, read once."""
    return _read(str(data()))

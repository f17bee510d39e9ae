"""The engine: a cluster of Ray, and tasks that it spreads over it."""

from __future__ import annotations

import contextlib
import functools
import hashlib
import logging
import pathlib
import socket
from collections.abc import Callable, Iterator, Sequence
from typing import Any

from ramp import _ramp
from ramp._core import InputError, __version__

RETRIES = 3
"""How often Ray runs a task again whose worker was lost."""

LOOK = 0.2
"""Interval at which a request to end is looked for, s."""

REACH = 10.0
"""Time that a cluster has to answer, s."""

PROGRAM = pathlib.Path(str(_ramp.__file__)).parent / "bin" / "ramp"
"""The `ramp` command of this package."""


@contextlib.contextmanager
def connected(address: str | None) -> Iterator[Any]:
    """Ray, connected to the cluster at an address, to the one that runs here, or to a new one."""
    try:
        import ray
    except ImportError:
        raise InputError("the backend `ray` needs Ray: pip install 'ramp-benchmark[ray]'") from None
    own = not ray.is_initialized()
    if own:
        try:
            _reach(address)
            ray.init(address=address, log_to_driver=False, logging_level=logging.ERROR, include_dashboard=False)
        except (OSError, RuntimeError, ValueError, SystemExit) as error:
            where = "on this machine" if address is None else f"at {address}"
            reason = (str(error).strip().splitlines() or ["no answer"])[0]
            raise InputError(f"there is no cluster of Ray {where}: {reason}") from None
    try:
        yield ray
    finally:
        if own:
            ray.shutdown()


def _reach(address: str | None) -> None:
    """Fails at once if nothing listens at an address of the form HOST:PORT. Ray itself tries for minutes."""
    host, _, port = (address or "").rpartition(":")
    if host and port.isdigit() and "/" not in host:
        socket.create_connection((host.strip("[]"), int(port)), timeout=REACH).close()


def spread(
    ray: Any, work: Callable[..., Any], tasks: Sequence[tuple[Any, ...]], is_ended: Callable[[], bool] = lambda: False
) -> Iterator[tuple[int, Any]]:
    """Makes a task of each tuple of arguments; the index and the reference of each as it is finished.

    The first argument of ``work`` is this build, for :func:`refusal`. ``is_ended`` stops all.
    """
    task = ray.remote(num_cpus=1, max_retries=RETRIES)(work)
    waiting = {task.remote(build(), *arguments): index for index, arguments in enumerate(tasks)}
    while waiting and not is_ended():
        done, _ = ray.wait(list(waiting), timeout=LOOK)
        for reference in done:
            yield waiting.pop(reference), reference


def refusal(driver: str) -> str | None:
    """Why this node cannot work for a driver with that build, if it cannot."""
    if build() == driver:
        return None
    return f"a node has another build of ramp ({__version__}): install the same one on all"


@functools.cache
def build() -> str:
    """The hash of the compiled module and of the program: two builds of one version may differ."""
    whole = hashlib.sha256()
    for file in (pathlib.Path(str(_ramp.__file__)), PROGRAM):
        whole.update(hashlib.sha256(file.read_bytes() if file.exists() else b"").digest())
    return whole.hexdigest()

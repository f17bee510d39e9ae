"""Films of episodes."""

from __future__ import annotations

import base64
import functools
import os
import pathlib
import subprocess
import tempfile

from ramp._core import InputError


class Film:
    """The film of an episode, eight times as fast as the robot; Jupyter shows it.

    It is made from the log of the episode, which is run again for it: that takes some seconds, when it is
    first shown.

    >>> film = ramp.Film("easy-1.mcap", seen_from="wrist")
    """

    def __init__(self, log: str | os.PathLike[str], *, seen_from: str = "free") -> None:
        """Names the film.

        Args:
            log: The log, as ``ramp.run(record=…)`` writes it.
            seen_from: ``free``, which follows the work, ``wrist`` or ``birds-eye``.

        """
        if seen_from not in ("free", "wrist", "birds-eye"):
            raise InputError(f"a film is seen from `free`, `wrist` or `birds-eye`, not from `{seen_from}`")
        self.log = pathlib.Path(log)
        self.seen_from = seen_from

    @functools.cached_property
    def gif(self) -> bytes:
        """The film as GIF."""
        program = pathlib.Path(__file__).parent / "bin" / "ramp"
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "film.gif"
            command = [str(program), "replay", str(self.log), "--video", str(file), "--video-from", self.seen_from]
            done = subprocess.run(command, capture_output=True, text=True, check=False)
            if not file.exists():
                raise InputError(done.stderr.strip() or f"{self.log}: no film of it could be made")
            return file.read_bytes()

    def save(self, file: str | os.PathLike[str]) -> None:
        """Writes the film as GIF."""
        pathlib.Path(file).write_bytes(self.gif)

    def _repr_html_(self) -> str:
        return f'<img alt="{self.log.name}" src="data:image/gif;base64,{base64.b64encode(self.gif).decode()}">'

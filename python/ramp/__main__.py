"""The `ramp` command: the program that comes with the package, in place of this one."""

from __future__ import annotations

import os
import pathlib
import sys


def main() -> None:
    """Becomes the `ramp` command, which starts this Python again where it needs the package."""
    os.environ.setdefault("RAMP_PYTHON", sys.executable)
    program = pathlib.Path(__file__).parent / "bin" / "ramp"
    os.execv(program, [str(program), *sys.argv[1:]])


if __name__ == "__main__":
    main()

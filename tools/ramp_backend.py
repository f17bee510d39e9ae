"""The build backend of the Python package: maturin, with what a usable wheel needs.

maturin's own backend leaves libmujoco out of a wheel that pip builds; this one has it put in. That changes
the library that cargo has built, and cargo would take it for fresh the next time, so the crate is touched
first. The `ramp` command goes into the package as a program of its own, with its libmujoco beside it.
"""

from __future__ import annotations

import os
import pathlib
import shutil
import subprocess
from typing import Any

import maturin
from maturin import (  # noqa: F401
    get_requires_for_build_wheel,
    prepare_metadata_for_build_wheel,
)

ROOT = pathlib.Path(__file__).resolve().parent.parent
PACKAGE = ROOT / "python" / "ramp"
MUJOCO = "libmujoco.so.3.17.0" if os.uname().sysname == "Linux" else "libmujoco.3.17.0.dylib"


def build_wheel(
    wheel_directory: str,
    config_settings: dict[str, Any] | None = None,
    metadata_directory: str | None = None,
) -> str:
    """Builds the wheel, with libmujoco, the data and the command in it."""
    settings = dict(config_settings or {})
    settings.setdefault("build-args", "--compatibility pypi")
    _add_command()
    (ROOT / "crates" / "ramp-py" / "src" / "lib.rs").touch()
    return str(maturin.build_wheel(wheel_directory, settings, metadata_directory))


def _add_command() -> None:
    """Builds the `ramp` command, and puts it and its library into the package's folder."""
    # As `cargo run` builds it, so that what is built is shared.
    command = ["cargo", "build", "--release", "--locked", "--bin", "ramp", "--message-format", "short"]
    subprocess.run(command, cwd=ROOT, check=True)
    target = pathlib.Path(os.environ.get("CARGO_TARGET_DIR") or ROOT / "target")
    own = os.environ.get("MUJOCO_DYNAMIC_LINK_DIR")
    library = pathlib.Path(own or ROOT / ".deps" / "mujoco-3.17.0") / MUJOCO
    for source, folder in [(target / "release" / "ramp", "bin"), (library, "lib")]:
        (PACKAGE / folder).mkdir(exist_ok=True)
        shutil.copy2(source, PACKAGE / folder / source.name)
    strip = shutil.which("strip")
    if strip:
        subprocess.run([strip, str(PACKAGE / "bin" / "ramp")], check=True)

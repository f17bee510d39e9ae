"""The formats of data sets, and the packages that they need."""

from __future__ import annotations

import importlib
import importlib.util
from typing import Any

from ramp._core import InputError

NEEDED = {"lerobot": ("pyarrow", "av", "PIL"), "hdf5": ("h5py",), "zarr": ("zarr",)}
"""The formats, and the packages that read and write each."""

MODULES = {"lerobot": "ramp.demos.lerobot", "hdf5": "ramp.demos.hdf5", "zarr": "ramp.demos.zarr_buffer"}


def need(form: str) -> None:
    """Raises an error if a package for a format is missing."""
    if form not in NEEDED:
        raise InputError(f"there is no format {form!r}; there are {', '.join(NEEDED)}")
    missing = [name for name in NEEDED[form] if importlib.util.find_spec(name) is None]
    if missing:
        names = " and ".join(missing)
        raise InputError(f"the format {form} needs {names}: pip install 'ramp-benchmark[data]'")


def module(form: str) -> Any:
    """The module of a format: it has ``write`` and ``actions``."""
    return importlib.import_module(MODULES[form])

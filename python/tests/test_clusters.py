"""The example with GNU parallel, as `docs/src/howto/run-on-a-cluster.md` has it."""

import os
import pathlib
import shutil
import subprocess
import sys

import pytest


def test_gnu_parallel_runs_a_folder_for_each_seed(tmp_path):
    program = shutil.which("parallel")
    if program is None or b"GNU parallel" not in subprocess.run([program, "--version"], capture_output=True).stdout:
        pytest.skip("SKIPPED: GNU parallel is not installed")
    path = f"{pathlib.Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    bench = "ramp bench easy-1 --track state --world ideal --first-seed {} --repeats 1 -o arr/{}"
    run = {"cwd": tmp_path, "env": {**os.environ, "PATH": path}, "check": True}
    subprocess.run([program, bench, ":::", "1", "2"], **run)
    subprocess.run(["ramp", "report", "arr/1", "arr/2", "-o", "report.html"], **run)
    assert "2 of 2<small>" in (tmp_path / "report.html").read_text()

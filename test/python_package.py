# SPDX-License-Identifier: BSD-3-Clause
"""Where the tests of the Python package find it, and what they share."""
import os
import pathlib
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
PROGRAMS = pathlib.Path(os.environ["POSEFUSION_PROGRAMS"])
PACKAGES = PROGRAMS.parent / "python3" / "dist-packages"
BUILT = bool(list((PACKAGES / "posefusion").glob("_core.*.so")))
NOT_BUILT = "skipped: built without pybind11"

if BUILT:
    sys.path.insert(0, str(PACKAGES))


def run(*command):
    done = subprocess.run([str(word) for word in command], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                          text=True)
    assert done.returncode == 0, f"{command}: {done.stderr}"
    return done.stdout

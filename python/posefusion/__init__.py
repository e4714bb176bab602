# SPDX-License-Identifier: BSD-3-Clause
"""Dense RGB-D SLAM among moving people: colour and depth in, poses and a map without the people out.

What is below is loaded when it is first used: in ROS this is also the package of the messages, which
need no core.
"""
import importlib

_NAMES = ("Camera", "Errors", "Frame", "InputError", "Map", "Recording", "Result", "Slam", "Statistics",
          "open_folder", "read_tum", "write_tum")


def __getattr__(name):
    if name == "evaluate":
        return importlib.import_module("posefusion.evaluate")
    if name in _NAMES:
        return getattr(importlib.import_module("posefusion._core"), name)
    raise AttributeError("module 'posefusion' has no attribute '%s'" % name)


def __dir__():
    return sorted(set(globals()) | set(_NAMES) | {"evaluate"})

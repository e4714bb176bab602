# SPDX-License-Identifier: BSD-3-Clause
"""The core as a library: built without ROS, installed, used by a project outside."""
import os
import pathlib
import shutil
import subprocess
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent
PROGRAMS = pathlib.Path(os.environ["POSEFUSION_PROGRAMS"])
FRAMES = 15


def run(*command):
    done = subprocess.run([str(word) for word in command], stdout=subprocess.PIPE,
                          stderr=subprocess.PIPE, text=True)
    assert done.returncode == 0, f"{command}: {done.stderr}"
    return done.stdout


def poses(text):
    return [line for line in text.splitlines() if len(line.split()) == 8 and line[0] != "#"]


class Library(unittest.TestCase):
    @unittest.skipUnless(shutil.which("ccache"), "skipped: no ccache, the core would be compiled twice")
    def test_examples_outside_give_the_trajectory_of_the_program(self):
        with tempfile.TemporaryDirectory() as folder:
            sequence, output = pathlib.Path(folder, "sequence"), pathlib.Path(folder, "output")
            run(PROGRAMS / "posefusion_simulate", "empty_box", "--duration", FRAMES / 30, "--output", sequence)
            said = run(ROOT / "scripts" / "test_library", sequence)
            run(PROGRAMS / "posefusion_run", sequence, "--mode", "pfh", "--set", "frame.max_depth_m=5",
                "--output", output)
            expected = poses((output / "latest" / "trajectory.txt").read_text())
        self.assertGreater(len(expected), FRAMES // 2)
        self.assertEqual(poses(said), expected)
        self.assertIn(f"{len(expected)} poses", said)
        self.assertIn("camera at 0.000 0.000 0.000 m", said)
        self.assertRegex(said, r"\n[1-9]\d+ surfels\n")

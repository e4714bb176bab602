# SPDX-License-Identifier: BSD-3-Clause
"""posefusion_baseline: OpenCV's odometries on the frames of a recording."""
import json
import os
import pathlib
import subprocess
import tempfile
import unittest

PROGRAMS = pathlib.Path(os.environ["POSEFUSION_PROGRAMS"])
BASELINE = PROGRAMS / "posefusion_baseline"
FRAMES = 15


def run(*words):
    done = subprocess.run([str(word) for word in words], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    return done.returncode, done.stdout, done.stderr


@unittest.skipUnless(BASELINE.is_file(), "skipped: built without opencv_contrib")
class Baseline(unittest.TestCase):
    def test_a_folder_and_its_bag_give_the_same_trajectory(self):
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            run(PROGRAMS / "posefusion_simulate", "empty_box", "--duration", FRAMES / 30, "--output", folder / "seq")
            run(PROGRAMS / "posefusion_to_bag", folder / "seq", folder / "seq.bag")
            found = {}
            for method in ("rgbd_icp", "rgbd", "icp"):
                for source in ("seq", "seq.bag"):
                    code, said, wrong = run(BASELINE, folder / source, "--method", method, "--output", folder / "t.txt")
                    self.assertEqual(code, 0, wrong)
                    answer = json.loads(said)
                    self.assertEqual((answer["method"], answer["frames"]), (method, FRAMES))
                    self.assertGreater(answer["frames_per_s"], 0)
                    self.assertLess(answer["ate_rmse_m"], 0.05)
                    found[method, source] = (folder / "t.txt").read_text()
                    self.assertEqual(len(found[method, source].splitlines()), 2 + FRAMES)
                self.assertEqual(found[method, "seq"], found[method, "seq.bag"])
            self.assertEqual(len(set(found.values())), 3, "each method is another")

    def test_errors_are_reported(self):
        self.assertEqual(run(BASELINE, "nowhere")[0], 1)
        code, _, wrong = run(BASELINE, "nowhere", "--method", "dvo")
        self.assertEqual(code, 105)
        self.assertIn("rgbd_icp", wrong)

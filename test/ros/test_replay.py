# SPDX-License-Identifier: BSD-3-Clause
"""replay.launch as a user starts it, against the offline runner."""
import os
import pathlib
import shutil
import socket
import subprocess
import tempfile
import unittest

FRAMES = 8
TIME_LIMIT_S = 150
# The stock manager cannot load a library built with AddressSanitizer.
SANITIZE = os.environ.get("POSEFUSION_SANITIZE", "false")


def program(name):
    return os.environ["POSEFUSION_PROGRAMS"] + "/" + name


def free_port():
    with socket.socket() as probe:
        probe.bind(("localhost", 0))
        return probe.getsockname()[1]


def poses(path):
    lines = pathlib.Path(path).read_text().splitlines()
    return [line for line in lines if not line.startswith("#")]


class Replay(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp(prefix="posefusion_replay_")
        cls.bag = cls.folder + "/sequence.bag"
        cls.call(program("posefusion_simulate"), "box_walker", "--output", cls.folder + "/sequence",
                 "--duration", f"{FRAMES / 30:.3f}")
        cls.call(program("posefusion_to_bag"), cls.folder + "/sequence", cls.bag)

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.folder)

    @classmethod
    def call(cls, *command, expect=0):
        environment = dict(os.environ, ROS_HOSTNAME="localhost", ROS_HOME=cls.folder + "/ros")
        done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                              timeout=TIME_LIMIT_S, env=environment, cwd=cls.folder)
        if expect is not None and done.returncode != expect:
            raise AssertionError(f"{command} gave {done.returncode}:\n{done.stdout}")
        return done.stdout

    def replay(self, *arguments):
        return self.call("roslaunch", "-p", str(free_port()), "posefusion", "replay.launch",
                         "timeout_s:=60", "sanitize:=" + SANITIZE, *arguments, expect=None)

    def test_lossless_replay_is_the_offline_run(self):
        text = self.replay("bag:=" + self.bag, "detector:=recorded",
                           "output:=" + self.folder + "/ros_run")
        self.assertIn(f"{FRAMES} frames sent, {FRAMES} fused", text)
        self.assertIn("in " + self.folder + "/ros_run", text)
        self.call(program("posefusion_run"), self.bag, "--detector", "recorded", "--output",
                  self.folder + "/offline")
        offline = poses(self.folder + "/offline/trajectory.txt")
        self.assertEqual(len(offline), FRAMES)
        self.assertEqual(poses(self.folder + "/ros_run/trajectory.txt"), offline)
        self.assertEqual(pathlib.Path(self.folder, "ros_run/map.ply").read_bytes(),
                         pathlib.Path(self.folder, "offline/map.ply").read_bytes())

    def test_real_time_replay_ends_by_itself(self):
        text = self.replay("bag:=" + self.folder + "/sequence", "detector:=none",
                           "lossless:=false", "rate:=0.5", "output:=" + self.folder + "/live")
        self.assertIn(f"{FRAMES} frames sent", text)
        self.assertTrue(os.path.exists(self.folder + "/live/trajectory.txt"), text)

    def test_a_missing_bag_is_named(self):
        text = self.replay("bag:=/nowhere/x.bag", "detector:=none",
                           "output:=" + self.folder + "/nothing")
        self.assertIn("/nowhere/x.bag: does not exist", text)
        self.assertFalse(os.path.exists(self.folder + "/nothing"))

    def test_the_bag_writer_leaves_nothing_half_done(self):
        text = self.call(program("posefusion_to_bag"), self.folder + "/sequence",
                         self.folder + "/nowhere/x.bag", expect=1)
        self.assertIn("nowhere/x.bag: cannot be written", text)
        text = self.call(program("posefusion_to_bag"), self.folder + "/ros", self.folder + "/x.bag",
                         expect=1)
        self.assertFalse(list(pathlib.Path(self.folder).glob("x.bag*")), text)


if __name__ == "__main__":
    unittest.main()

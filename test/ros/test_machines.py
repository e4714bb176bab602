# SPDX-License-Identifier: BSD-3-Clause
"""robot.launch and workstation.launch on a bag."""
import json
import os
import pathlib
import shutil
import signal
import subprocess
import tempfile
import time
import unittest

from test_replay import SANITIZE, free_port, poses, program

SECONDS = 2
FRAMES = 15 * SECONDS  # half of the camera's frames
# Small pictures, played slowly: the test must not depend on the speed of the machine.
SMALL = ("--set", "camera.width=160", "--set", "camera.height=120", "--set", "depth.disparity_steps=32", "--set",
         "depth.lateral=0.25", "--set", "color.samples=1")
SPEED = "0.2"
PATIENCE_S = 120
TOPICS = ("color_topic:=/camera/rgb/image_color", "depth_topic:=/camera/depth_registered/image",
          "camera_info_topic:=/camera/rgb/camera_info")


class Machines(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp(prefix="posefusion_machines_")
        self.addCleanup(shutil.rmtree, self.folder)
        self.environment = dict(os.environ, ROS_HOSTNAME="localhost", ROS_HOME=self.folder + "/ros", PWD=self.folder,
                                ROS_MASTER_URI=f"http://localhost:{free_port()}", PYTHONUNBUFFERED="1")

    def call(self, *command, expect=0):
        done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=PATIENCE_S,
                              env=self.environment, cwd=self.folder)
        self.assertEqual(done.returncode, expect, done.stdout)
        return done.stdout

    def start(self, name, *command):
        with open(f"{self.folder}/{name}.log", "w", encoding="utf-8") as log:
            process = subprocess.Popen(command, stdout=log, stderr=subprocess.STDOUT, env=self.environment,
                                       cwd=self.folder)
        self.addCleanup(self.end, process)
        return process

    @staticmethod
    def end(process):
        if process.poll() is None:
            process.send_signal(signal.SIGINT)
        process.wait(PATIENCE_S)

    def said(self, name):
        return pathlib.Path(self.folder, name + ".log").read_text(encoding="utf-8")

    def wait_for(self, what, condition):
        end = time.monotonic() + PATIENCE_S
        while not condition():
            if time.monotonic() > end:
                self.fail(f"no {what}: {self.said('robot')}\n{self.said('workstation')}")
            time.sleep(0.2)

    def subscribers(self, topic):
        done = subprocess.run(["rostopic", "info", topic], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True,
                              env=self.environment)
        return done.stdout.partition("Subscribers:")[2].count("* /")

    def launch_both(self):
        self.start("roscore", "roscore", "-p", self.environment["ROS_MASTER_URI"].rpartition(":")[2])
        self.start("robot", "roslaunch", "--wait", "posefusion", "robot.launch", *TOPICS, "sanitize:=" + SANITIZE)
        station = self.start("workstation", "roslaunch", "--wait", "posefusion", "workstation.launch", "rviz:=false",
                             "detector:=none", "output:=map", "calibration_folder:=none", "sanitize:=" + SANITIZE)
        self.wait_for("unpacker", lambda: self.subscribers("/robot/compressed_frame") > 0)
        self.wait_for("chain", lambda: self.subscribers("/posefusion/static_depth") > 0)
        self.wait_for("gate", lambda: self.subscribers("/camera/rgb/image_color") > 0)
        return station

    def test_a_bag_on_one_side_is_a_map_on_the_other(self):
        self.call(program("posefusion_simulate"), "box_walker", "--duration", str(SECONDS), *SMALL, "--output", "sequence")
        self.call(program("posefusion_to_bag"), "sequence", "sequence.bag")
        station = self.launch_both()
        self.call("rosbag", "play", "--quiet", "--delay", "1", "--rate", SPEED, "sequence.bag")
        time.sleep(2)
        self.end(station)
        found = poses(self.folder + "/map/latest/trajectory.txt")
        # A busy machine drops some of them.
        self.assertGreater(len(found), FRAMES // 3, self.said("robot") + self.said("workstation"))
        self.assertLessEqual(len(found), FRAMES + 2)
        errors = json.loads(self.call(program("posefusion_evaluate"), "sequence",
                                      "map/latest/trajectory.txt", "--json"))
        self.assertLess(errors["ate_m"]["rmse"], 0.05, errors)
        for name in ("robot", "workstation"):
            self.assertNotRegex(self.said(name), r"ERROR|FATAL|has died|unknown parameter", name)

    def test_what_is_wrong_ends_the_launch_at_once(self):
        for launch, argument, said in (
                ("workstation", "outptu:=x", "argument outptu is unknown, expected one of frame_topic"),
                ("workstation", "mode:=fast", "mode"), ("robot", "rate:=3", "argument rate is unknown"),
                ("robot", "camera:=webcam", "argument camera:=webcam, expected one of"),
                ("robot", "image_transport:=theora", "image_transport")):
            text = self.call("roslaunch", "-p", str(free_port()), "posefusion", launch + ".launch", argument,
                             *(["rviz:=false", "detector:=none"] if launch == "workstation" else []), expect=1)
            self.assertIn(said, text)
            self.assertNotIn("process[", text, "nothing was started")


if __name__ == "__main__":
    unittest.main()

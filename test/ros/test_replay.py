# SPDX-License-Identifier: BSD-3-Clause
"""replay.launch against the offline runner."""
import json
import os
import pathlib
import random
import re
import shutil
import signal
import socket
import subprocess
import tempfile
import unittest
import xmlrpc.client

FRAMES = 8
TIME_LIMIT_S = 150
# The stock manager cannot load a library built with AddressSanitizer.
SANITIZE = os.environ.get("POSEFUSION_SANITIZE", "false")


def program(name):
    return os.environ["POSEFUSION_PROGRAMS"] + "/" + name


def free_port():
    """Below those that the system gives to connections: one of another test would take it before a master does."""
    while True:
        port = random.randrange(15000, 30000)
        with socket.socket() as probe:
            if probe.connect_ex(("localhost", port)) != 0:
                return port


def poses(path):
    lines = pathlib.Path(path).read_text().splitlines()
    return [line for line in lines if not line.startswith("#")]


def bend(nodes):
    """The nodes of a calibration file, with a field that is not zero."""
    numbers = nodes[nodes.index("[") + 1:-1].split(",")
    return "nodes_per_m: [" + ", ".join(str(0.004 * ((i % 3) - 1)) for i, _ in enumerate(numbers)) + "]"


class Replay(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp(prefix="posefusion_replay_")
        cls.bag = cls.folder + "/sequence.bag"
        cls.call(program("posefusion_simulate"), "box_walker", "--output", cls.folder + "/sequence",
                 "--duration", f"{FRAMES / 30:.3f}")
        cls.call(program("posefusion_to_bag"), cls.folder + "/sequence", cls.bag)
        shutil.copytree(cls.folder + "/sequence", cls.folder + "/no_people",
                        ignore=shutil.ignore_patterns("people*.json"))

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.folder)

    @classmethod
    def call(cls, *command, expect=0, port=11311):
        environment = dict(os.environ, ROS_HOSTNAME="localhost", ROS_HOME=cls.folder + "/ros", PWD=cls.folder,
                           ROS_MASTER_URI=f"http://localhost:{port}")
        done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                              timeout=TIME_LIMIT_S, env=environment, cwd=cls.folder)
        if expect is not None and done.returncode != expect:
            raise AssertionError(f"{command} gave {done.returncode}:\n{done.stdout}")
        return done.stdout

    def replay(self, *arguments, expect=0, port=None):
        return self.call("roslaunch", "posefusion", "replay.launch", "timeout_s:=60",
                         "sanitize:=" + SANITIZE, *arguments, expect=expect, port=port or free_port())

    def test_lossless_replay_is_the_offline_run(self):
        text = self.replay("bag:=" + self.bag, "detector:=recorded",
                           "output:=" + self.folder + "/ros_run")
        self.assertIn(f"{FRAMES} frames sent, {FRAMES} fused", text)
        self.assertIn("in " + self.folder + "/ros_run/", text)
        self.assertNotRegex(text, r"REQUIRED|WARN|ERROR|FATAL|has died|escalat")
        self.assertLess(text.count("\n * /"), 60, "parameters at the start")
        self.call(program("posefusion_run"), self.bag, "--detector", "recorded", "--output",
                  self.folder + "/offline")
        offline = poses(self.folder + "/offline/latest/trajectory.txt")
        self.assertEqual(len(offline), FRAMES)
        self.assertEqual(poses(self.folder + "/ros_run/latest/trajectory.txt"), offline)
        self.assertEqual(pathlib.Path(self.folder, "ros_run/latest/map.ply").read_bytes(),
                         pathlib.Path(self.folder, "offline/latest/map.ply").read_bytes())
        self.check_summaries(text)

    def test_a_calibration_corrects_depth_as_in_the_offline_run(self):
        plain = self.folder + "/sequence/depth_field.yaml"
        bent = pathlib.Path(self.folder, "bent.yaml")
        bent.write_text(re.sub(r"nodes_per_m: \[[^\]]*\]", lambda found: bend(found[0]), pathlib.Path(plain).read_text()))
        text = self.replay("bag:=" + self.bag, "detector:=recorded", "output:=calibrated", "calibration:=bent.yaml")
        self.assertIn(f"{FRAMES} frames sent, {FRAMES} fused", text)
        runs = {}
        for name, arguments in (("corrected", ("--calibration", str(bent))), ("uncorrected", ())):
            self.call(program("posefusion_run"), self.bag, "--detector", "recorded", "--output",
                      self.folder + "/" + name, *arguments)
            runs[name] = pathlib.Path(self.folder, name, "latest/map.ply").read_bytes()
        self.assertEqual(pathlib.Path(self.folder, "calibrated/latest/map.ply").read_bytes(), runs["corrected"])
        self.assertNotEqual(runs["corrected"], runs["uncorrected"])
        self.check_that_a_folder_tells_it_too(bent, runs["corrected"])

    def check_that_a_folder_tells_it_too(self, calibration, expected):
        cameras = pathlib.Path(self.folder, "cameras")
        cameras.mkdir()
        shutil.copy(calibration, cameras / "camera_rgb_optical_frame.yaml")
        text = self.replay("bag:=" + self.bag, "detector:=recorded", "output:=kept", "calibration_folder:=cameras")
        self.assertIn(f"depth is corrected by {cameras}/camera_rgb_optical_frame.yaml", text)
        self.assertEqual(pathlib.Path(self.folder, "kept/latest/map.ply").read_bytes(), expected)

    def test_a_calibration_that_does_not_hold_is_named(self):
        file = pathlib.Path(self.folder, "wrong.yaml")
        file.write_text("nonsense")
        arguments = ("bag:=sequence.bag", "detector:=none", "output:=wrong", "calibration:=wrong.yaml")
        text = self.replay(*arguments, expect=1)
        self.assertIn(str(file), text)
        self.assertNotIn("process[", text, "nothing was started")
        text = self.replay(*arguments, "check:=false")
        self.assertRegex(text, rf"cannot start: {file}")
        self.assertIn("the chain has ended", text)
        plain = pathlib.Path(self.folder, "sequence/depth_field.yaml").read_text()
        file.write_text(re.sub(r"fx: [0-9.]+", "fx: 900", plain))
        text = self.replay(*arguments, expect=None)
        self.assertIn(f"{FRAMES} frames sent, {FRAMES} bad_input", text)
        self.assertIn("the calibration of depth is of a camera of another view", text)

    def check_summaries(self, text):
        """The summary of the replay equals that of the offline run in the keys that both have."""
        replayed, offline = (json.loads(pathlib.Path(self.folder, run, "summary.json").read_text())
                             for run in ("ros_run/latest", "offline/latest"))
        for key in ("version", "frames", "masks", "surfels", "configuration"):
            self.assertEqual(replayed[key], offline[key], key)
        for key in ("ate_rmse_m", "ate_held_rmse_m"):
            self.assertAlmostEqual(replayed[key], offline[key], places=6, msg=key)
        self.assertNotIn("loops", replayed)
        self.assertIn("tracking", replayed["stages"])
        self.assertGreater(pathlib.Path(self.folder, "ros_run/latest/map.png").stat().st_size, 10000)
        self.assertEqual(pathlib.Path(self.folder, "ros_run/latest/people.png").read_bytes(),
                         pathlib.Path(self.folder, "offline/latest/people.png").read_bytes())
        self.assertIn("ATE ", text)
        self.assertRegex(text, r"results +" + self.folder + "/ros_run/")

    def test_real_time_replay_ends_by_itself(self):
        text = self.replay("bag:=" + self.folder + "/sequence", "detector:=none",
                           "lossless:=false", "rate:=0.5", "output:=" + self.folder + "/live")
        self.assertIn(f"{FRAMES} frames sent", text)
        self.assertTrue(os.path.exists(self.folder + "/live/latest/trajectory.txt"), text)

    def test_localize_only_leaves_the_map_file_as_it_is(self):
        self.replay("bag:=sequence.bag", "detector:=none", "output:=mapped")
        file = pathlib.Path(self.folder, "mapped/latest/map.pfdb")
        shutil.copy(file, self.folder + "/known.pfdb")
        before = file.read_bytes()
        # The camera is found by the sixth frame: that takes the evidence of several.
        text = self.replay("bag:=sequence.bag", "detector:=none", "output:=localized", "map:=known.pfdb",
                           "localize_only:=true")
        self.assertRegex(text, rf"{FRAMES} frames sent, \d located, \d unproven")
        self.assertIn("saved map.ply and trajectory.txt", text)
        self.assertNotRegex(text, r"ERROR|has died|no loop closer")
        self.assertEqual(pathlib.Path(self.folder, "known.pfdb").read_bytes(), before)
        self.assertFalse(list(pathlib.Path(self.folder).glob("localized/*/map.pfdb")))

    def test_relative_paths_are_those_of_the_call(self):
        text = self.replay("bag:=sequence.bag", "detector:=none", "output:=near", "frame_id:=eye",
                           "color_topic:=/camera/rgb/image_color", "max_frames:=2")
        self.assertIn("2 frames sent, 2 fused", text)
        self.assertTrue(os.path.exists(self.folder + "/near/latest/map.ply"), text)

    def test_what_is_wrong_ends_the_launch_at_once(self):
        file_in_the_way = pathlib.Path(self.folder, "file")
        file_in_the_way.write_text("")
        for arguments, said in (
                (("bag:=/nowhere/x.bag",), "/nowhere/x.bag: does not exist"),
                (("outptu:=x",), "argument outptu is unknown, expected one of bag lossless"),
                (("mode:=fast",), "mode"),
                (("config:=nothing.yaml",), self.folder + "/nothing.yaml"),
                (("detector:=network", "model:=nothing.pb"), self.folder + "/nothing.pb"),
                (("publish_tf:=ture",), "publish_tf:=ture, expected true or false"),
                (("color_topic:=/nothing",), "topic /nothing is not in the bag"),
                (("output:=file",), self.folder + "/file"),
                (("map:=nothing.pfdb",), self.folder + "/nothing.pfdb: cannot be opened"),
                (("map:=file",), self.folder + "/file: is no map of posefusion"),
                (("localize_only:=true",), "localize_only and continue_map need a map:=FILE"),
                (("detector:=recorded", "bag:=" + self.folder + "/no_people"), "no recorded people")):
            if not any(a.startswith("bag:=") for a in arguments):
                arguments += ("bag:=sequence.bag",)
            if not any(a.startswith("detector:=") for a in arguments):
                arguments += ("detector:=none",)
            if not any(a.startswith("output:=") for a in arguments):
                arguments += ("output:=nothing",)
            text = self.replay(*arguments, expect=1)
            self.assertIn(said, text, arguments)
            self.assertNotIn("process[", text, "nothing was started")
            self.assertFalse(os.path.exists(self.folder + "/nothing"), arguments)

    def test_the_end_of_the_chain_ends_the_replay(self):
        """Without the check of the arguments; roslaunch itself returns 0 even if its nodes fail."""
        text = self.replay("bag:=sequence.bag", "detector:=none", "output:=failed",
                           "check:=false", "mode:=fast")
        self.assertIn("cannot start", text)
        self.assertIn("the chain has ended", text)
        self.assertFalse(os.path.exists(self.folder + "/failed/latest"))

    def test_a_setting_of_the_session_before_does_not_stay(self):
        master = subprocess.Popen(["roscore", "-p", str(port := free_port())],
                                  stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self.addCleanup(master.wait)
        self.addCleanup(master.terminate)
        there = dict(os.environ, ROS_MASTER_URI=f"http://localhost:{port}", ROS_HOSTNAME="localhost")
        for command in (("get", "/run_id"), ("set", "/posefusion/fusion/tracking/max_distnce", "1")):
            for _ in range(100):
                done = subprocess.run(["rosparam", *command], env=there, stdout=subprocess.DEVNULL,
                                      stderr=subprocess.DEVNULL)
                if done.returncode == 0:
                    break
        text = self.replay("bag:=sequence.bag", "detector:=none", "max_frames:=2", "output:=clean",
                           port=port)
        self.assertIn("2 frames sent, 2 fused", text)

    def test_rviz_only_with_a_display(self):
        for launch in ("slam.launch", "replay.launch"):
            for display, rviz in (("", False), (":9", True)):
                environment = dict(os.environ, DISPLAY=display)
                done = subprocess.run(
                    ["roslaunch", "--nodes", "posefusion", launch, "check:=false", "bag:=x",
                     *(("rviz:=true",) if launch == "replay.launch" and rviz else ())],
                    env=environment, stdout=subprocess.PIPE, text=True, check=True)
                self.assertEqual("/posefusion/rviz" in done.stdout, rviz, done.stdout)

    def test_a_second_chain_has_its_own_map_frame(self):
        for arguments, frame in (((), "map"), (("namespace:=left",), "left_map")):
            done = subprocess.run(
                ["roslaunch", "--dump-params", "posefusion", "slam.launch", "check:=false",
                 "rviz:=false", *arguments], stdout=subprocess.PIPE, text=True, check=True)
            self.assertRegex(done.stdout, rf"fusion/map_frame: {frame}\n")

    def slam(self, options, *arguments):
        return subprocess.run(
            ["roslaunch", *options, "posefusion", "slam.launch", "rviz:=false", "detector:=none",
             *arguments], cwd=self.folder, text=True, stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT, env=dict(os.environ, PWD=self.folder))

    def test_a_map_is_saved_by_whatever_signal_the_chain_ends(self):
        for number, (target, sent) in enumerate((("roslaunch", signal.SIGHUP), ("roslaunch", signal.SIGTERM),
                                                 ("manager", signal.SIGTERM), ("manager", signal.SIGHUP))):
            with self.subTest(target=target, signal=sent):
                self.check_that_a_signal_saves(target, sent, self.folder + f"/signal_{number}")

    def check_that_a_signal_saves(self, target, sent, output):
        port = free_port()
        environment = dict(os.environ, ROS_HOSTNAME="localhost", ROS_HOME=self.folder + "/ros", PWD=self.folder,
                           ROS_MASTER_URI=f"http://localhost:{port}")
        with open(output + ".log", "w+", encoding="utf-8") as log:
            chain = subprocess.Popen(
                ["roslaunch", "-p", str(port), "posefusion", "slam.launch", "rviz:=false", "detector:=none",
                 "color_topic:=rgb/image_color", "depth_topic:=depth_registered/image",
                 "camera_info_topic:=rgb/camera_info", "sanitize:=" + SANITIZE, "output:=" + output],
                cwd=self.folder, env=environment, stdout=log, stderr=subprocess.STDOUT)
            self.addCleanup(chain.kill)
            text = self.call(program("posefusion_feeder"), self.folder + "/sequence", "__ns:=/posefusion",
                             "_lossless:=false", "_rate:=0.2", "_clock:=false", port=port)
            self.assertIn(f"{FRAMES} frames sent", text)
            self.assertFalse(os.path.exists(output + "/latest/trajectory.txt"))
            os.kill(chain.pid if target == "roslaunch" else self.pid_of_manager(port), sent)
            chain.wait(TIME_LIMIT_S)
            log.seek(0)
            said = log.read()
        self.assertTrue(os.path.exists(output + "/latest/trajectory.txt"), said)
        self.assertTrue(os.path.exists(output + "/latest/map.pfdb"), said)
        self.assertGreater(len(poses(output + "/latest/trajectory.txt")), 0)
        self.assertNotIn("escalating", said)

    def pid_of_manager(self, port):
        master = xmlrpc.client.ServerProxy(f"http://localhost:{port}")
        node = master.lookupNode("/test", "/posefusion/manager")[2]
        return xmlrpc.client.ServerProxy(node).getPid("/test")[2]

    def test_slam_takes_the_settings_of_a_camera(self):
        done = self.slam(["--dump-params"], "camera:=realsense_d4xx", "camera_name:=eye",
                         "image_transport:=compressed", "depth_stamp_offset_s:=-0.01")
        self.assertEqual(done.returncode, 0, done.stdout)
        for line in (r"blur_gate/camera_settings: \S+/config/cameras/realsense_d4xx.yaml",
                     r"fusion/camera_settings: \S+/config/cameras/realsense_d4xx.yaml",
                     r"blur_gate/camera_name: eye", r"blur_gate/image_transport: compressed",
                     r"blur_gate/depth_stamp_offset_s: -0.01"):
            self.assertRegex(done.stdout, line)
        self.assertNotIn("depth_image_transport", done.stdout)
        own = pathlib.Path(self.folder, "own.yaml")
        own.write_text("input: {camera_name: eye, depth_unit: 2}")
        for arguments, said in (
                (("camera:=realsens",), "camera:=realsens, expected one of azure_kinect kinect_v2"),
                (("camera_settings:=own.yaml",), self.folder + "/own.yaml: input.depth_unit"),
                (("image_transport:=theora",), "'theora', expected one of raw, compressed")):
            done = self.slam([], *arguments)
            self.assertEqual(done.returncode, 1, arguments)
            self.assertIn(said, done.stdout)
            self.assertNotIn("process[", done.stdout, "nothing was started")

    def test_the_bag_writer_leaves_nothing_half_done(self):
        text = self.call(program("posefusion_to_bag"), self.folder + "/sequence",
                         self.folder + "/nowhere/x.bag", expect=1)
        self.assertIn("nowhere/x.bag: cannot be written", text)
        text = self.call(program("posefusion_to_bag"), self.folder + "/ros", self.folder + "/x.bag",
                         expect=1)
        self.assertFalse(list(pathlib.Path(self.folder).glob("x.bag*")), text)


if __name__ == "__main__":
    unittest.main()

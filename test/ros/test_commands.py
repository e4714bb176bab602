# SPDX-License-Identifier: BSD-3-Clause
"""Every ROS command of README.md and docs/ros-api.md, as it stands there."""
import os
import pathlib
import re
import shutil
import signal
import subprocess
import tempfile
import time
import unittest
import xmlrpc.client

from test_replay import SANITIZE, free_port, program

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
DOCUMENTS = ("README.md", "docs/ros-api.md")
PATIENCE_S = 60
STEADY_S = 8  # a program that still runs after this has started well
# Without windows, without a network's weights, and without waiting for a device.
UNATTENDED = {"slam.launch": ["rviz:=false", "detector:=none"], "replay.launch": ["detector:=none"],
              "openni2.launch": []}


def commands():
    """(document, command) of all lines of code that begin with ros..., without their comments."""
    found = []
    for document in DOCUMENTS:
        text = (ROOT / document).read_text()
        for line in re.findall(r"^(?:    )?(ros[a-z]+ .*)$", text, re.MULTILINE):
            found.append((document, re.sub(r"\s+#.*", "", line)))
    return found


def runs_on(command):
    return re.match(r"roslaunch posefusion (slam|openni2)\.launch|rosbag play", command)


def ready_to_run(command):
    launch = re.search(r"posefusion (\w+\.launch)", command)
    words = UNATTENDED[launch[1]] + ["sanitize:=" + SANITIZE] if launch else []
    if launch and (launch[1] == "openni2.launch" or "--ros-args" in command):
        words = []
    if command.startswith("rosbag play"):
        words = ["--loop", "--quiet"]
    return " ".join([command, *words])


class Commands(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp(prefix="posefusion_commands_")
        self.addCleanup(shutil.rmtree, self.folder)
        self.environment = dict(os.environ, ROS_HOSTNAME="localhost", PYTHONUNBUFFERED="1",
                                ROS_HOME=self.folder + "/ros", PWD=self.folder)
        self.new_master()
        sequence = self.folder + "/sequence"
        self.run_to_its_end(program("posefusion_simulate") + " box_walker --duration 2 --output " + sequence)
        self.run_to_its_end(program("posefusion_to_bag") + f" {sequence} FILE.bag")

    def new_master(self):
        self.environment["ROS_MASTER_URI"] = f"http://localhost:{free_port()}"

    def start(self, command):
        log = open(self.folder + "/log", "w+", encoding="utf-8")
        process = subprocess.Popen(["bash", "-c", "exec " + command], cwd=self.folder, stdout=log,
                                   stderr=subprocess.STDOUT, env=self.environment)
        process.log = log
        self.addCleanup(self.end, process)
        return process

    def end(self, process):
        if process.poll() is None:
            process.send_signal(signal.SIGINT)
            process.wait(PATIENCE_S)
        process.log.close()

    def said(self, process):
        process.log.seek(0)
        return process.log.read()

    def run_to_its_end(self, command):
        done = subprocess.run(["bash", "-c", command], cwd=self.folder, env=self.environment, text=True,
                              timeout=PATIENCE_S, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        self.assertEqual(done.returncode, 0, f"{command}\n{done.stdout}")
        self.assertNotRegex(done.stdout, r"ERROR|success: False", command)
        return done.stdout

    def wait_for(self, condition, what):
        end = time.monotonic() + PATIENCE_S
        while not condition():
            self.assertLess(time.monotonic(), end, what)
            time.sleep(0.2)

    def test_short_commands_run_beside_a_chain_that_sees_a_bag(self):
        play = [c for d, c in commands() if c.startswith("rosbag play")]
        feed = [c for d, c in commands() if "slam.launch color_topic:=/camera/rgb/image_color" in c]
        self.assertEqual((len(play), len(feed)), (1, 1), commands())
        self.start("roscore -p " + self.environment["ROS_MASTER_URI"].rpartition(":")[2])
        self.wait_for(lambda: subprocess.run(["rosparam", "get", "/run_id"], env=self.environment,
                                             stdout=subprocess.DEVNULL,
                                             stderr=subprocess.DEVNULL).returncode == 0, "roscore")
        self.run_to_its_end("rosparam set use_sim_time true")
        chain = self.start(ready_to_run(feed[0]))
        self.start(ready_to_run(play[0]))
        # A mesh needs stable surfels, which this bag is too short for: test_chain_surfaces saves one.
        short = [c for d, c in commands()
                 if not runs_on(c) and "replay.launch" not in c and "save_mesh" not in c]
        self.assertGreater(len(short), 6)
        self.run_to_its_end("rostopic echo -n 1 /posefusion/status")  # it has begun
        for command in short:
            self.assertIsNone(chain.poll(), self.said(chain))
            self.run_to_its_end(command)
        self.check_that_python_knows_all_types()
        self.check_that_a_refusal_says_why()

    def check_that_a_refusal_says_why(self):
        value = "{config: {doubles: [{name: blur/threshold, value: -1}]}}"
        done = subprocess.run(["rosservice", "call", "/posefusion/blur_gate/set_parameters", value], text=True,
                              env=self.environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        self.assertNotEqual(done.returncode, 0)
        self.assertIn("blur/threshold is -1, expected 0 to", done.stdout)
        values = self.run_to_its_end("rosrun dynamic_reconfigure dynparam get /posefusion/blur_gate")
        self.assertIn("nothing is changed: blur/threshold is -1", values)

    def check_that_python_knows_all_types(self):
        """rostopic and rosservice need the classes of every topic and service that we have."""
        master = xmlrpc.client.ServerProxy(self.environment["ROS_MASTER_URI"])
        topics = {topic: kind for topic, kind in master.getTopicTypes("/test")[2]
                  if topic.startswith("/posefusion/") and kind != "*"}
        self.assertGreater(len(topics), 15)
        types = set(topics.values())
        services = {self.run_to_its_end("rosservice type /posefusion/fusion/" + name).strip()
                    for name in ("save_map", "load_map", "set_mode", "pause", "resume", "reset", "get_map",
                                 "calibrate")}
        import roslib.message
        for name in types:
            self.assertIsNotNone(roslib.message.get_message_class(name), name)
        for name in services:
            self.assertIsNotNone(roslib.message.get_service_class(name), name)

    def test_launch_files_start_as_documented(self):
        launches = sorted({c for d, c in commands() if c.startswith("roslaunch")})
        self.assertGreater(len(launches), 6)
        if SANITIZE == "true":  # the camera runs in the stock manager, which is built without
            launches = [c for c in launches if "openni2.launch" not in c]
        for command in launches:
            self.new_master()
            if not runs_on(command):
                text = self.run_to_its_end(ready_to_run(command))
                self.assertTrue("fused" in text or "--ros-args" in command, text)
                continue
            process = self.start(ready_to_run(command))
            time.sleep(STEADY_S)
            text = self.said(process)
            self.assertIsNone(process.poll(), f"{command}\n{text}")
            self.assertIn("process[", text, command)
            self.assertNotRegex(text, r"has died|FATAL|RLException", command)
            self.end(process)


if __name__ == "__main__":
    unittest.main()

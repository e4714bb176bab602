# SPDX-License-Identifier: BSD-3-Clause
"""The parts `live` and `start` of scripts/bench: the nodelets fed at 30 frames a second, as by a camera. Measured are
the fate of each frame, the time until its transform, and the time from roslaunch to the first pose."""
import os
import re
import shutil
import statistics
import time

from bench_report import Failed, call
from bench_ros import ROOT, Session, there_and_back
from bench_runs import PROGRAMS, Runs, note

FRAMES = 900
RATE_HZ = 30
TIME_LIMIT_S = 600
LAUNCHES = 3
TOPICS = {"color_topic": "/camera/rgb/image_color", "depth_topic": "/camera/depth_registered/image",
          "camera_info_topic": "/camera/rgb/camera_info"}


class Live(Runs):
    def live(self):
        kitchen = self.output / "live_input"
        there_and_back(self.options.data / "kitchen_people", kitchen, FRAMES, RATE_HZ)
        self.live_rows("walking_static, people recorded", self.simulated("walking_static", self.options.seeds[0]),
                       True, "detector:=recorded")
        self.live_rows("kitchen_people there and back, embedded", kitchen, False, "detector:=embedded")
        for detector in ("network", "network+embedded"):
            self.live_rows(f"kitchen_people there and back, {detector}", kitchen, False,
                           f"detector:={detector}", f"model:={self.options.model}")

    def live_rows(self, name, sequence, has_bars, *arguments):
        bag = self.output / "live.bag"
        call(PROGRAMS / "posefusion_to_bag", sequence, bag)
        note(f"feeding the nodelets at 30 frames a second: {name}")
        with Session(self.output / "live_session") as session:
            said = session.run("replay", "roslaunch", "posefusion", "replay.launch", f"bag:={bag}", "lossless:=false",
                               f"output:={self.output / 'live'}", *arguments, timeout=TIME_LIMIT_S)
        bag.unlink()
        counts, median_ms, most_ms = understand(said)
        for what, count in counts.items():
            self.row(f"live, 30 Hz, {name}: frames {what}", count, "", digits=0)
        dropped = sum(count for what, count in counts.items() 
                      if what.startswith("dropped") or what == "without a status")
        self.row(f"live, 30 Hz, {name}: frames dropped", dropped, "", 0 if has_bars else None, digits=0)
        self.row(f"live, 30 Hz, {name}: from a frame to its transform, median", median_ms, "ms", digits=1)
        self.row(f"live, 30 Hz, {name}: from a frame to its transform, 99 % within", most_ms, "ms",
                 100 if has_bars else None, digits=1)

    def start(self):
        """From the call of `roslaunch posefusion slam.launch`, where frames come already, to a pose."""
        sequence, bag = self.output / "start_input", self.output / "start.bag"
        there_and_back(self.options.data / "kitchen_people", sequence, FRAMES, RATE_HZ)
        call(PROGRAMS / "posefusion_to_bag", sequence, bag)
        times_s, loads = [], []
        for i in range(LAUNCHES):
            note(f"launch {i + 1} of {LAUNCHES}")
            loads.append(os.getloadavg()[0])
            times_s.append(self.time_to_pose_s(bag))
        bag.unlink()
        self.row("roslaunch slam.launch to the first pose, median of 3", statistics.median(times_s), "s", 5, digits=1)
        self.row("the same, processes that waited for the 2 cores besides (load)", max(loads), "", digits=1)

    def time_to_pose_s(self, bag):
        folder = self.output / "start_session"
        shutil.rmtree(folder, ignore_errors=True)
        with Session(folder) as session:
            session.start("play", "rosbag", "play", "--quiet", bag)
            session.start("pose", "rostopic", "echo", "-n", "1", "/posefusion/pose/header")
            session.wait_for(lambda: "not appear to be published" in session.said("pose"), "rostopic")
            began = time.monotonic()
            launch = session.start("launch", "roslaunch", "posefusion", "slam.launch", "rviz:=false",
                                   *(f"{name}:={topic}" for name, topic in TOPICS.items()))
            session.wait_for(lambda: "frame_id" in session.said("pose") or launch.poll() is not None, "a pose")
            if launch.poll() is not None:
                raise Failed(f"slam.launch: {session.said('launch')[-500:]}")
            return time.monotonic() - began


def understand(said):
    """The feeder's sentence "900 frames sent, 636 fused, ...; from frame to TF 80.1 ms median, 99.0 ms
    99 %": {"sent": 900, "fused": 636, ...} and the two times in milliseconds."""
    found = re.search(r"(\d+) frames (sent.*); from frame to TF ([0-9.]+) ms median, ([0-9.]+) ms 99 %", said)
    if not found:
        raise Failed(f"no figures from the feeder: {said[-500:]}")
    counted = re.findall(r"(\d+) ([^,]+)", f"{found[1]} {found[2]}")
    return {what: int(count) for count, what in counted}, float(found[3]), float(found[4])

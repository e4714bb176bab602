# SPDX-License-Identifier: BSD-3-Clause
"""The part `soak` of scripts/bench: two chains in two namespaces on one ROS master for ten minutes.
Neither may grow, and nothing of one may reach the other."""
import os
import pathlib
import re
import statistics
import time

from bench_live import understand
from bench_report import Failed
from bench_ros import Session, there_and_back
from bench_runs import PROGRAMS, Runs, note

# Namespace, test data, and the first stamp: a frame that strays is known by its stamp.
CHAINS = (("left", "kitchen_people", 1.0), ("right", "kitchen_static", 100001.0))
RATE_HZ = 6  # two chains on two cores, whatever else runs
SECONDS = 600
LOOK_S = 2
GROWTH_MB = 20  # from the second third to the last
TRANSFORMS = 60


class Soak(Runs):
    def soak(self):
        seconds = self.options.duration or SECONDS
        note(f"two chains for {seconds:g} s")
        with Session(self.output / "soak_session") as session:
            launches = {name: session.start(
                f"{name}_chain", "roslaunch", "posefusion", "slam.launch", f"namespace:={name}", "rviz:=false",
                "color_topic:=rgb/image_color", "depth_topic:=depth_registered/image",
                "camera_info_topic:=rgb/camera_info", f"output:={self.output / 'soak'}") for name, _, _ in CHAINS}
            feeders = {name: self.feed(session, name, data, start_s, seconds) for name, data, start_s in CHAINS}
            session.wait_for(lambda: all(fused_topics(session, name) for name in launches), "both chains")
            memory = {name: [] for name in launches}
            crossed = self.watch(session, launches, feeders, memory)
            said = {name: session.said(f"{name}_feeder") for name in feeders}
        for name in launches:
            self.chain_rows(name, memory[name], said[name])
        self.fact("soak, two chains: topics and transforms that cross", not crossed, ", ".join(sorted(crossed)) or "none")

    def feed(self, session, name, data, start_s, seconds):
        sequence = self.output / f"soak_{name}"
        there_and_back(self.options.data / data, sequence, int(seconds * RATE_HZ), RATE_HZ, start_s)
        return session.start(f"{name}_feeder", PROGRAMS / "posefusion_feeder", sequence, f"__ns:={name}",
                             "_lossless:=false", "_clock:=false", f"_frame_id:={name}_eye")

    @staticmethod
    def watch(session, launches, feeders, memory):
        """Until the feeders end; `memory` grows. Returns what crosses."""
        transforms = session.start("tf", "rostopic", "echo", "-n", TRANSFORMS, "/tf")
        while any(feeder.poll() is None for feeder in feeders.values()):
            for name, launch in launches.items():
                if launch.poll() is not None:
                    raise Failed(f"{name}: the chain has ended: {session.said(f'{name}_chain')[-500:]}")
                memory[name].append(resident_mb(manager_of(launch.pid)))
            crossed = crossed_topics(session, tuple(launches))
            time.sleep(LOOK_S)
        Session.end(transforms)
        return crossed | crossed_transforms(session.said("tf"), tuple(launches))

    def chain_rows(self, name, memory_mb, said):
        if len(memory_mb) < 6:
            raise Failed(f"{name}: too short to measure growth")
        third = len(memory_mb) // 3
        middle, last = statistics.median(memory_mb[third:2 * third]), statistics.median(memory_mb[-third:])
        self.row(f"soak, {name}, memory in the last third", last, "MB", digits=0)
        self.row(f"soak, {name}, memory, last third less the second", last - middle, "MB", GROWTH_MB, digits=1)
        counts = understand(said)[0]
        self.row(f"soak, {name}, part of the frames fused", counts.get("fused", 0) / counts["sent"], "", digits=3)
        strays = said.count("of which no frame is under way")
        self.row(f"soak, {name}, reports of frames that are not its own", strays, "", 0, digits=0)


def fused_topics(session, name):
    return any(topic == f"/{name}/status" and nodes for topic, nodes in session.master.getSystemState("/bench")[2][0])


def crossed_topics(session, names):
    """Topics of a namespace that a node of another one publishes or takes."""
    publishers, subscribers, services = session.master.getSystemState("/bench")[2]
    crossed = set()
    for topic, nodes in publishers + subscribers + services:
        for name in names:
            others = [other for other in names if other != name]
            if topic.startswith(f"/{name}/") and any(n.startswith(f"/{o}/") for o in others for n in nodes):
                crossed.add(topic)
    return crossed


def crossed_transforms(text, names):
    """`text` is what rostopic says of /tf."""
    pairs = set(re.findall(r'frame_id: "(\w+)"\n *child_frame_id: "(\w+)"', text))
    expected = {(f"{name}_map", f"{name}_eye") for name in names}
    return {f"{parent} -> {child}" for parent, child in pairs ^ expected}


def manager_of(launch):
    """The process id of the nodelet manager that a roslaunch has started."""
    for task in pathlib.Path("/proc", str(launch), "task").iterdir():
        for child in (task / "children").read_text().split():
            words = pathlib.Path("/proc", child, "cmdline").read_bytes().split(b"\0")
            if os.path.basename(words[0]) == b"nodelet" and b"manager" in words[1:2]:
                return int(child)
    raise Failed("no nodelet manager below roslaunch")


def resident_mb(process):
    status = pathlib.Path("/proc", str(process), "status").read_text()
    return int(re.search(r"VmRSS:\s+(\d+) kB", status)[1]) / 1024

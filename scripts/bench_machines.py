# SPDX-License-Identifier: BSD-3-Clause
"""The part `machines` of scripts/bench: the camera in one network namespace, the chain in another, and a link between
them that is good, is cut for five seconds, or delays and loses packets."""
import json
import shutil
import statistics
import time

from bench_link import Namespaces, congestion_controls, has_netem, why_not
from bench_report import Failed, call
from bench_ros import ROOT, Session, rows_of, there_and_back, turning
from bench_runs import PROGRAMS, Runs, note

ROBOT, STATION = 0, 1
RATE_HZ, SENT_HZ = 30, 15
SECONDS = 20
CUT_AFTER_S, CUT_S = 6, 5
MOST_MB_S, MOST_LOST, MOST_BACK_S = 4, 5, 1
LOSSY = (50, 2)  # ms and percent
TOPICS = ("color_topic:=/camera/rgb/image_color", "depth_topic:=/camera/depth_registered/image",
          "camera_info_topic:=/camera/rgb/camera_info")
FRAMES, UNPACKED, STATUS = "/robot/compressed_frame", "/posefusion/rgb/camera_info", "/posefusion/status"
POSE = [f"pose.{part}" for part in ("position.x", "position.y", "position.z", "orientation.x", "orientation.y",
                                    "orientation.z", "orientation.w")]


class Computers(Session):
    """A ROS master on the robot, and programs on both."""

    def __init__(self, folder, link):
        shutil.rmtree(folder, ignore_errors=True)
        super().__init__(folder)
        self.link = link
        self.environment["ROS_MASTER_URI"] = f"http://{link.addresses[ROBOT]}:{self.port}"

    def start(self, name, *command, computer=ROBOT):
        return super().start(name, *self.link.inside(computer), "env", "-u", "ROS_HOSTNAME",
                             f"ROS_IP={self.link.addresses[computer]}", *command)

    def is_up(self):
        process = self.start("list", "rostopic", "list")
        return process.wait() == 0

    def probe(self, name, topic, *fields, computer):
        self.start(name, "python3", ROOT / "scripts" / "bench_probe.py", topic, *fields, computer=computer)
        self.wait_for(lambda: "ready" in self.said(name), name)

    def noted(self, name):
        """[(when, stamp, bytes, fields)] of a probe."""
        lines = [line.split() for line in self.said(name).rpartition("\n")[0].splitlines()
                 if line[:1].isdigit()]
        return [(float(w[0]), w[1], int(w[2]), w[3:]) for w in lines]


class Machines(Runs):
    def machines(self):
        sentence = why_not()
        if sentence:
            return self.fact("two computers: not measured", None, sentence)
        self.machines_bag()
        with Namespaces(("robot", "station")) as link:
            self.machines_good(link)
            self.machines_cut(link, "connected anew", MOST_BACK_S)
            self.machines_cut(link, "TCP alone", None, "renew_after_s:=0")
            self.machines_lossy(link)

    def machines_bag(self):
        source, sequence = self.options.data / "kitchen_static", self.output / "machines_input"
        frames = SECONDS * RATE_HZ
        there_and_back(source, sequence, frames, RATE_HZ, float(int(time.time())))
        stamps = [row[0] for row in rows_of(sequence / "associations.txt")]
        truth = rows_of(source / "groundtruth.txt")
        with open(sequence / "groundtruth.txt", "w", encoding="ascii") as out:
            for i, stamp in enumerate(stamps):
                print(stamp, *truth[turning(i, len(truth))][1:], file=out)
        call(PROGRAMS / "posefusion_to_bag", sequence, self.output / "machines.bag")

    def session(self, link, during, *arguments):
        """Plays the bag on the robot; calls `during` when it has begun. Returns the
        lines of the probes, the bytes that the robot sent, and the result of `during`."""
        note("a bag from one namespace to the other")
        with Computers(self.output / "machines_session", link) as session:
            session.start("robot", "roslaunch", "posefusion", "robot.launch", *TOPICS)
            session.start("station", "roslaunch", "--wait", "posefusion", "workstation.launch", "rviz:=false",
                          "detector:=none", f"output:={self.output / 'machines'}", "calibration_folder:=none", *arguments,
                          computer=STATION)
            session.probe("sent", FRAMES, computer=ROBOT)
            session.probe("received", UNPACKED, computer=STATION)
            session.probe("status", STATUS, "located", *POSE, computer=STATION)
            time.sleep(3)  # until all are connected
            before = link.bytes_sent(ROBOT)
            play = session.start("play", "rosbag", "play", "--quiet", self.output / "machines.bag")
            session.wait_for(lambda: session.noted("sent"), "the first frame")
            moments = during(session) if during else None
            if play.wait(4 * SECONDS) != 0:
                raise Failed(f"rosbag: {session.said('play')[-300:]}")
            sent_bytes = link.bytes_sent(ROBOT) - before
            time.sleep(2)
            noted = {name: session.noted(name) for name in ("sent", "received", "status")}
        if not noted["sent"] or not noted["received"]:
            raise Failed(f"nothing came: {session.said('robot')[-300:]} {session.said('station')[-300:]}")
        return noted, sent_bytes, moments

    def machines_good(self, link):
        link.connect()
        noted, sent_bytes, _ = self.session(link, None)
        seconds = noted["sent"][-1][0] - noted["sent"][0][0]
        self.row("two computers: frames sent each second", (len(noted["sent"]) - 1) / seconds, "Hz", digits=1)
        self.row("two computers: bandwidth of the link", sent_bytes / seconds / 1e6, "MB/s", MOST_MB_S, digits=2)
        self.link_rows("two computers", noted, MOST_LOST)
        self.pose_rows("two computers", noted)

    def link_rows(self, name, noted, bar):
        sent = {stamp: when for when, stamp, _, _ in noted["sent"]}
        ways_ms = [1e3 * (when - sent[stamp]) for when, stamp, _, _ in noted["received"] if stamp in sent]
        self.row(f"{name}: frames lost", 100 * (1 - len(ways_ms) / len(sent)), "%", bar, digits=1)
        self.row(f"{name}: from the packer to the chain, median", statistics.median(ways_ms), "ms", digits=0)
        self.row(f"{name}: the same, 95 % within", sorted(ways_ms)[int(0.95 * (len(ways_ms) - 1))], "ms", digits=0)

    def pose_rows(self, name, noted):
        """Of the live poses."""
        file = self.output / "machines_poses.txt"
        located = [(stamp, pose) for _, stamp, _, (found, *pose) in noted["status"] if found == "True"]
        file.write_text("".join(" ".join((stamp, *pose)) + "\n" for stamp, pose in located))
        errors = json.loads(call(PROGRAMS / "posefusion_evaluate", self.output / "machines_input", file, "--json"))
        share = len(located) / len(noted["received"])
        self.row(f"{name}: frames with a pose, of those received", 100 * share, "%", digits=1)
        self.row(f"{name}: false poses", errors["false_poses"], "", 0, digits=0)
        self.row(f"{name}: ATE", errors["ate_m"]["rmse"], "m", digits=3)

    def machines_cut(self, link, how, bar, *arguments):
        link.connect()

        def cut(_):
            time.sleep(CUT_AFTER_S)
            link.cut()
            time.sleep(CUT_S)
            link.mend()
            return time.monotonic()

        noted, _, mended = self.session(link, cut, *arguments)
        name = f"cut for {CUT_S} s, {how}"
        first = {kind: min((n for n in noted[kind] if n[0] > mended and (kind != "status" or n[3][0] == "True")),
                           default=None) for kind in ("received", "status")}
        sent = {stamp: when for when, stamp, _, _ in noted["sent"]}
        for kind, what in (("received", "the first frame"), ("status", "the first pose")):
            back_s = first[kind][0] - mended if first[kind] else None
            self.row(f"{name}: {what} after it", back_s, "s", bar, digits=2)
        old_s = [when - sent[stamp] for when, stamp, _, _ in noted["received"] if when > mended and stamp in sent]
        self.row(f"{name}: oldest frame that came after it", max(old_s, default=None), "s", digits=2)
        self.pose_rows(name, noted)

    def machines_lossy(self, link):
        by = "by netem" if has_netem() else "by a process, as this kernel has no netem"
        name = f"{LOSSY[0]} ms and {LOSSY[1]} % loss"
        self.fact(f"{name}: made", None, by)
        for control in ("bbr", "cubic"):
            if control not in congestion_controls():
                self.fact(f"{name}, TCP by {control}: not measured", None, f"this kernel has no {control}")
                continue
            link.connect(there=LOSSY, congestion_control=control)
            noted, _, _ = self.session(link, None)
            self.link_rows(f"{name}, TCP by {control}", noted, MOST_LOST if control == "bbr" else None)
            self.pose_rows(f"{name}, TCP by {control}", noted)
        if "bbr" in congestion_controls():
            link.connect(there=LOSSY, back=LOSSY, congestion_control="bbr")
            self.link_rows(f"{name} each way, TCP by bbr", self.session(link, None)[0], None)

#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The part `live` of scripts/bench: the nodelets fed at 30 frames a second, as by a camera. What
becomes of each frame, and how long after the camera has sent it its transform is there.

Called by itself (with ROS sourced) it feeds a bag and prints what it heard as JSON:

  scripts/bench_live.py BAG [argument of replay.launch ...]
"""
import collections
import json
import os
import pathlib
import shutil
import socket
import statistics
import subprocess
import sys
import time

FRAMES = 900
PERIOD_NS = 33333333
PATIENCE_S = 20
TIME_LIMIT_S = 600


class Live:
    """To be mixed into scripts/bench's Bench."""

    def live(self):
        from bench_report import call  # the other user of this file has no need of it
        root = pathlib.Path(__file__).resolve().parent.parent
        sequence, bag = self.output / "live_input", self.output / "live.bag"
        there_and_back(self.options.data / "kitchen_people", sequence, FRAMES)
        call(root / "devel" / "lib" / "posefusion" / "posefusion_to_bag", sequence, bag)
        print("  feeding the nodelets at 30 frames a second ...", file=sys.stderr)
        said = call("bash", "-c", f"source '{root}/devel/setup.bash' && exec \"$@\"", "bash",
                    "python3", __file__, bag, "detector:=network", f"model:={self.options.model}",
                    f"output:={self.output / 'live'}", timeout=TIME_LIMIT_S)
        bag.unlink()
        heard = json.loads(said.splitlines()[-1])
        self.row("live at 30 Hz, kitchen_people there and back, frames sent", heard["sent"], "", digits=0)
        for what, count in sorted(heard["outcomes"].items()):
            self.row(f"live at 30 Hz, frames {what}", count, "", digits=0)
        latency = sorted(1e3 * s for s in heard["latency_s"])
        self.row("live at 30 Hz, from the camera's message to TF, median",
                 statistics.median(latency), "ms", digits=1)
        self.row("live at 30 Hz, from the camera's message to TF, 99 %",
                 latency[int(0.99 * (len(latency) - 1))], "ms", digits=1)


def there_and_back(source, folder, frames):
    """A TUM folder with the images of another, forwards and backwards in turn, 30 a second."""
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    for name in ("rgb", "depth", "camera.yaml"):
        (folder / name).symlink_to(source / name)
    lines = [line.split() for line in (source / "associations.txt").read_text().splitlines()
             if line and not line.startswith("#")]
    with open(folder / "associations.txt", "w") as out:
        for i in range(frames):
            at = i % (2 * len(lines) - 2)
            _, color, _, depth = lines[at if at < len(lines) else 2 * len(lines) - 2 - at]
            stamp = f"{1 + i * PERIOD_NS / 1e9:.6f}"
            out.write(f"{stamp} {color} {stamp} {depth}\n")


class Listener:
    """What a robot hears of the chain, with the times at which it does."""

    def __init__(self):
        import rospy
        from posefusion.msg import TrackingStatus
        from rosgraph_msgs.msg import Clock
        from tf2_msgs.msg import TFMessage
        rospy.init_node("posefusion_bench_live", disable_signals=True)
        self.dropped = TrackingStatus.DROPPED
        self.fused = TrackingStatus.FUSED
        self.sent, self.placed, self.statuses = {}, {}, {}
        self.topics = [
            # The feeder sends a clock message with the stamp of each frame, just before the frame.
            rospy.Subscriber("/clock", Clock, lambda m: self.sent.setdefault(
                m.clock.to_nsec(), time.monotonic()), queue_size=1000),
            rospy.Subscriber("/tf", TFMessage, self.on_transforms, queue_size=1000),
            rospy.Subscriber("/posefusion/status", TrackingStatus, lambda m: self.statuses.setdefault(
                m.header.stamp.to_nsec(), (m.outcome, m.reason)), queue_size=1000)]

    def on_transforms(self, message):
        for transform in message.transforms:
            self.placed.setdefault(transform.header.stamp.to_nsec(), time.monotonic())

    def outcome(self, stamp):
        """In words, without the figures."""
        code, reason = self.statuses.get(stamp, (None, "without a status"))
        return "fused" if code == self.fused else reason if code == self.dropped else reason.split(":")[0]

    def heard(self):
        return {"sent": len(self.sent),
                "outcomes": collections.Counter(self.outcome(stamp) for stamp in self.sent),
                "latency_s": [self.placed[stamp] - begin for stamp, begin in self.sent.items()
                              if stamp in self.placed]}


def free_port():
    with socket.socket() as probe:
        probe.bind(("localhost", 0))
        return probe.getsockname()[1]


def wait_for_master(port):
    end = time.monotonic() + PATIENCE_S
    while time.monotonic() < end:
        with socket.socket() as probe:
            if probe.connect_ex(("localhost", port)) == 0:
                return
        time.sleep(0.05)
    raise RuntimeError("the ROS master does not come up")


def main():
    bag, arguments = os.path.abspath(sys.argv[1]), sys.argv[2:]
    port = free_port()
    os.environ.update(ROS_MASTER_URI=f"http://localhost:{port}", ROS_HOSTNAME="localhost")
    with subprocess.Popen(["rosmaster", "--core", "-p", str(port)], stdout=subprocess.DEVNULL) as master:
        try:
            wait_for_master(port)
            listener = Listener()  # before the first frame
            done = subprocess.run(["roslaunch", "posefusion", "replay.launch", f"bag:={bag}",
                                   "lossless:=false", *arguments], stdout=sys.stderr, check=False)
        finally:
            master.terminate()
    print(json.dumps(listener.heard()), flush=True)
    os._exit(done.returncode)  # rospy's threads wait for the master for ever


if __name__ == "__main__":
    main()

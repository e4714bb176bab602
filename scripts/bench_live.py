# SPDX-License-Identifier: BSD-3-Clause
"""The part `live` of scripts/bench: the nodelets fed at 30 frames a second, as by a camera. What
becomes of each frame, and how long after it was sent its transform is there."""
import os
import pathlib
import re
import shutil
import socket
import sys

from bench_report import Failed, call

ROOT = pathlib.Path(__file__).resolve().parent.parent
FRAMES = 900
PERIOD_S = 1 / 30
TIME_LIMIT_S = 600


class Live:
    """To be mixed into scripts/bench's Bench."""

    def live(self):
        sequence, bag = self.output / "live_input", self.output / "live.bag"
        there_and_back(self.options.data / "kitchen_people", sequence, FRAMES)
        call(ROOT / "devel" / "lib" / "posefusion" / "posefusion_to_bag", sequence, bag)
        print("  feeding the nodelets at 30 frames a second ...", file=sys.stderr)
        said = replay(bag, "detector:=network", f"model:={self.options.model}",
                      f"output:={self.output / 'live'}")
        bag.unlink()
        outcomes, median_ms, most_ms = understand(said)
        for what, count in outcomes:
            self.row(f"live, 30 Hz, kitchen_people there and back, frames {what}", count, "", digits=0)
        self.row("live, 30 Hz, from a frame to its transform, median", median_ms, "ms", digits=1)
        self.row("live, 30 Hz, from a frame to its transform, 99 % within", most_ms, "ms", digits=1)


def there_and_back(source, folder, frames):
    """A TUM folder with the images of another, forwards and backwards in turn, 30 a second."""
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    for name in ("rgb", "depth", "camera.yaml"):
        (folder / name).symlink_to(source / name)
    lines = [line.split() for line in (source / "associations.txt").read_text().splitlines()
             if line and not line.startswith("#")]
    with open(folder / "associations.txt", "w", encoding="ascii") as out:
        for i in range(frames):
            at = i % (2 * len(lines) - 2)
            _, color, _, depth = lines[at if at < len(lines) else 2 * len(lines) - 2 - at]
            stamp = f"{1 + i * PERIOD_S:.6f}"
            out.write(f"{stamp} {color} {stamp} {depth}\n")


def replay(bag, *arguments):
    """What roslaunch says of a replay in real time."""
    with socket.socket() as probe:
        probe.bind(("localhost", 0))
        port = probe.getsockname()[1]
    environment = {**os.environ, "ROS_HOSTNAME": "localhost", "ROS_MASTER_URI": f"http://localhost:{port}"}
    return call("bash", "-c", f"source '{ROOT}/devel/setup.bash' && exec roslaunch \"$@\" 2>&1", "bash", "--port",
                str(port), "posefusion", "replay.launch", f"bag:={bag}", "lossless:=false", *arguments,
                timeout=TIME_LIMIT_S, env=environment)


def understand(said):
    """The feeder's sentence "900 frames sent, 636 fused, ...; from frame to TF 80.1 ms median, 99.0 ms
    99 %": [("sent", 900), ("fused", 636), ...] and the two times in milliseconds."""
    found = re.search(r"(\d+) frames (sent.*); from frame to TF ([0-9.]+) ms median, ([0-9.]+) ms 99 %", said)
    if not found:
        raise Failed(f"no figures from the feeder: {said[-500:]}")
    counted = re.findall(r"(\d+) ([^,]+)", f"{found[1]} {found[2]}")
    return [(what, int(count)) for count, what in counted], float(found[3]), float(found[4])

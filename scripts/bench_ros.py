# SPDX-License-Identifier: BSD-3-Clause
"""For the parts of scripts/bench that run the nodelets: a ROS master of their own, and input."""
import os
import pathlib
import shutil
import signal
import socket
import subprocess
import time
import xmlrpc.client

from bench_report import Failed

ROOT = pathlib.Path(__file__).resolve().parent.parent
PATIENCE_S = 60


def hear_interrupts():
    """A bench in the background ignores them, and so would all that it starts: it ends them so."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


class Session:
    """A ROS master and the programs started beside it; all of them end with the session."""

    def __init__(self, folder):
        self.folder = folder
        folder.mkdir(parents=True, exist_ok=True)
        with socket.socket() as probe:
            probe.bind(("localhost", 0))
            self.port = probe.getsockname()[1]
        address = f"http://localhost:{self.port}"
        self.environment = {**os.environ, "ROS_HOSTNAME": "localhost", "ROS_MASTER_URI": address,
                            "ROS_HOME": str(folder / "ros"), "PWD": str(folder), "PYTHONUNBUFFERED": "1"}
        self.master = xmlrpc.client.ServerProxy(address)
        self.processes = []

    def __enter__(self):
        self.start("roscore", "roscore", "-p", self.port)
        self.wait_for(self.is_up, "the ROS master")
        return self

    def __exit__(self, *_):
        for process in reversed(self.processes):
            self.end(process)

    def is_up(self):
        try:
            return self.master.getPid("/bench")[0] == 1
        except OSError:
            return False

    def start(self, name, *command):
        """The process; its output is in said(name)."""
        with open(self.folder / f"{name}.log", "w", encoding="utf-8") as log:
            process = subprocess.Popen(
                ["bash", "-c", f"source '{ROOT}/devel/setup.bash' && exec \"$@\"", "bash", *map(str, command)],
                cwd=self.folder, env=self.environment, stdout=log, stderr=subprocess.STDOUT,
                preexec_fn=hear_interrupts)
        self.processes.append(process)
        return process

    def said(self, name):
        return (self.folder / f"{name}.log").read_text(encoding="utf-8", errors="replace")

    def run(self, name, *command, timeout=PATIENCE_S):
        """The output of a program that ends by itself."""
        process = self.start(name, *command)
        if process.wait(timeout) != 0:
            raise Failed(f"{name}: {self.said(name)[-500:]}")
        return self.said(name)

    @staticmethod
    def end(process):
        if process.poll() is not None:
            return
        process.send_signal(signal.SIGINT)
        try:
            process.wait(PATIENCE_S)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()

    def wait_for(self, condition, what, patience_s=PATIENCE_S):
        end = time.monotonic() + patience_s
        while not condition():
            if time.monotonic() > end:
                raise Failed(f"waited {patience_s} s in vain for {what}")
            time.sleep(0.05)


def rows_of(path):
    """The rows of a list of the TUM benchmark."""
    return [line.split() for line in path.read_text().splitlines() if line and not line.startswith("#")]


def turning(i, count):
    """The number of the frame that comes i-th on a way of so many frames, walked there and back in turn."""
    at = i % (2 * count - 2)
    return at if at < count else 2 * count - 2 - at


def there_and_back(source, folder, frames, rate_hz, start_s=1.0):
    """A TUM folder with the images of another, forwards and backwards in turn."""
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    for name in ("rgb", "depth", "camera.yaml"):
        (folder / name).symlink_to(source / name)
    lines = rows_of(source / "associations.txt")
    with open(folder / "associations.txt", "w", encoding="ascii") as out:
        for i in range(frames):
            _, color, _, depth = lines[turning(i, len(lines))]
            stamp = f"{start_s + i / rate_hz:.6f}"
            out.write(f"{stamp} {color} {stamp} {depth}\n")

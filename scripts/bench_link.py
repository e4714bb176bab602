# SPDX-License-Identifier: BSD-3-Clause
"""Two computers in one: network namespaces with a link between them that can be cut, and that delays and loses
packets, by tc netem where the kernel has it, else by a process that hands each packet on."""
import collections
import fcntl
import os
import random
import selectors
import struct
import subprocess
import sys
import time

from bench_report import Failed, call

SUBNET = "10.213.47"
MTU = 1500
NO_HOST = "02:00:00:00:00:99"
TUNSETIFF, IFF_TUN, IFF_NO_PI = 0x400454CA, 0x0001, 0x1000
PACKETS = 1000  # that wait in each direction, as netem has it


def why_not():
    """A sentence where this machine cannot have two network namespaces; empty where it can."""
    if os.geteuid() != 0:
        return "network namespaces need root"
    probe = f"probe{os.getpid()}"
    try:
        call("ip", "netns", "add", probe)
        call("ip", "netns", "delete", probe)
    except FileNotFoundError:
        return "network namespaces need the program ip (package iproute2)"
    except Failed as error:
        return f"this machine permits no network namespaces: {error}"
    return ""


def has_netem():
    """Whether the kernel has it."""
    name = f"nl{os.getpid()}"
    call("ip", "link", "add", f"{name}a", "type", "veth", "peer", "name", f"{name}b")
    try:
        call("tc", "qdisc", "add", "dev", f"{name}a", "root", "netem", "delay", "1ms")
        return True
    except (Failed, FileNotFoundError):
        return False
    finally:
        call("ip", "link", "delete", f"{name}a")


def congestion_controls():
    with open("/proc/sys/net/ipv4/tcp_available_congestion_control", encoding="ascii") as known:
        return known.read().split()


class Namespaces:
    """Two of them, each with an address; gone with the end of the `with`."""

    def __init__(self, names):
        self.names = [f"pf_{name}_{os.getpid()}" for name in names]
        self.addresses = [f"{SUBNET}.{i + 1}" for i in range(len(names))]
        self.forwarder = None

    def __enter__(self):
        for name in self.names:
            call("ip", "netns", "add", name)
            call("ip", "-n", name, "link", "set", "lo", "up")
        return self

    def __exit__(self, *_):
        self.disconnect()
        for name in self.names:
            subprocess.run(["ip", "netns", "delete", name], check=False)

    def inside(self, index):
        """The prefix of a command that runs there."""
        return ["ip", "netns", "exec", self.names[index]]

    def connect(self, there=(0, 0), back=(0, 0), congestion_control=""):
        """`there`, `back`: delay in ms and loss in percent, of what the first sends and the second;
        `congestion_control`: of TCP, empty: the default."""
        self.make_link(there, back)
        for name in self.names if congestion_control else ():
            call("ip", "-n", name, "route", "replace", f"{SUBNET}.0/24", "dev", "link0", "congctl", congestion_control)

    def make_link(self, there, back):
        self.disconnect()
        bad = any(there) or any(back)
        if bad and not has_netem():
            return self.connect_by_process(there, back)
        call("ip", "link", "add", "link0", "netns", self.names[0], "type", "veth", "peer", "name", "link0", "netns",
             self.names[1])
        self.address()
        for name, (delay_ms, loss_percent) in zip(self.names, (there, back)) if bad else ():
            # Segments of the size on a wire: otherwise netem loses 64 kB at a time.
            call("ip", "-n", name, "link", "set", "link0", "gso_max_segs", "1")
            call("tc", "-n", name, "qdisc", "add", "dev", "link0", "root", "netem", "limit", PACKETS, "delay",
                 f"{delay_ms}ms", "loss", f"{loss_percent}%")

    def address(self):
        for name, address in zip(self.names, self.addresses):
            call("ip", "-n", name, "address", "add", f"{address}/24", "dev", "link0")
            call("ip", "-n", name, "link", "set", "link0", "up")

    def connect_by_process(self, there, back):
        handles = [tunnel(f"pf{os.getpid()}_{i}") for i in range(2)]
        for i, name in enumerate(self.names):
            call("ip", "link", "set", f"pf{os.getpid()}_{i}", "netns", name, "name", "link0")
        self.address()
        self.forwarder = subprocess.Popen([sys.executable, __file__, *map(str, (*handles, *there, *back))],
                                          pass_fds=handles)
        for handle in handles:
            os.close(handle)

    def disconnect(self):
        if self.forwarder:
            self.forwarder.kill()
            self.forwarder.wait()
            self.forwarder = None
        subprocess.run(["ip", "-n", self.names[0], "link", "delete", "link0"], check=False, stderr=subprocess.DEVNULL)

    def cut(self):
        """Packets go to a missing host, as by a radio out of reach: no program gets an error."""
        for name, other in zip(self.names, reversed(self.addresses)):
            call("ip", "-n", name, "neighbour", "replace", other, "lladdr", NO_HOST, "nud", "permanent", "dev", "link0")

    def mend(self):
        for name, other in zip(self.names, reversed(self.addresses)):
            call("ip", "-n", name, "neighbour", "delete", other, "dev", "link0")

    def bytes_sent(self, index):
        said = call(*self.inside(index), "cat", "/sys/class/net/link0/statistics/tx_bytes")
        return int(said)


def tunnel(name):
    handle = os.open("/dev/net/tun", os.O_RDWR | os.O_NONBLOCK)
    fcntl.ioctl(handle, TUNSETIFF, struct.pack("16sH22x", name.encode(), IFF_TUN | IFF_NO_PI))
    return handle


class Direction:
    """Packets on their way from one handle to another."""

    def __init__(self, source, target, delay_ms, loss_percent, chance):
        self.source, self.target, self.chance = source, target, chance
        self.delay_s, self.loss = delay_ms / 1e3, loss_percent / 100
        self.waiting = collections.deque()

    def take(self, now):
        for _ in range(64):
            try:
                packet = os.read(self.source, MTU + 64)
            except OSError:
                return
            if self.chance.random() >= self.loss and len(self.waiting) < PACKETS:
                self.waiting.append((now + self.delay_s, packet))

    def give(self, now):
        while self.waiting and self.waiting[0][0] <= now:
            try:
                os.write(self.target, self.waiting.popleft()[1])
            except OSError:  # the other side is down
                return


def hand_on(first, second, there, back):
    chance = random.Random(1)
    ways = [Direction(first, second, *there, chance), Direction(second, first, *back, chance)]
    selector = selectors.DefaultSelector()
    for way in ways:
        selector.register(way.source, selectors.EVENT_READ, way)
    while True:
        due = [way.waiting[0][0] for way in ways if way.waiting]
        timeout = max(0.0, min(due) - time.monotonic()) if due else None
        for key, _ in selector.select(timeout):
            key.data.take(time.monotonic())
        for way in ways:
            way.give(time.monotonic())


if __name__ == "__main__":
    numbers = list(map(float, sys.argv[3:]))
    hand_on(int(sys.argv[1]), int(sys.argv[2]), numbers[:2], numbers[2:])

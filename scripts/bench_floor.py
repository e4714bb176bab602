# SPDX-License-Identifier: BSD-3-Clause
"""A floor of eight rooms, two of them alike: are they confused?"""
import bisect
import json
import math

from bench_maps import Maps
from bench_runs import poses

MIXED_UP_M = 1.0


def product(a, b):
    """Of two quaternions (x y z w)."""
    (ax, ay, az, aw), (bx, by, bz, bw) = a, b
    return (aw * bx + ax * bw + ay * bz - az * by, aw * by - ax * bz + ay * bw + az * bx,
            aw * bz + ax * by - ay * bx + az * bw, aw * bw - ax * bx - ay * by - az * bz)


def inverse(q):
    return (-q[0], -q[1], -q[2], q[3])


def turned(q, point):
    return product(product(q, (*point, 0.0)), inverse(q))[:3]


class Truth:
    """Where a simulated camera was, and which rooms there are."""

    def __init__(self, sequence):
        self.rooms = json.loads((sequence / "events.json").read_text())["rooms"]
        found = sorted((float(stamp), pose) for stamp, pose in poses(sequence / "groundtruth.txt").items())
        self.stamps, self.poses = [stamp for stamp, _ in found], [pose for _, pose in found]

    def pose(self, stamp):
        return self.poses[min(bisect.bisect_left(self.stamps, stamp), len(self.poses) - 1)]

    def ways_between_alike(self):
        """From each room to the others that look like it, in metres over the floor."""
        for one in self.rooms:
            for other in self.rooms:
                if one != other and one.get("like", one["name"]) == other.get("like", other["name"]):
                    yield [b - a for a, b in zip(one["low_m"], other["low_m"])]


def mixed_up(sequence, trajectory):
    """How many poses are off by as much as two rooms alike are apart: the camera sees into one, perhaps through its
    doorway, and is reported in the other. Poses are placed in the world by the first of them."""
    truth = Truth(sequence)
    ways = list(truth.ways_between_alike())
    reported = sorted((float(stamp), pose) for stamp, pose in poses(trajectory).items())
    (at, turn), (true_at, true_turn) = reported[0][1], truth.pose(reported[0][0])
    q_world_map = product(true_turn, inverse(turn))
    count = 0
    for stamp, (place, _) in reported:
        moved = turned(q_world_map, [p - a for p, a in zip(place, at)])
        error = [t + m - now for t, m, now in zip(true_at, moved, truth.pose(stamp)[0])]
        count += any(math.dist(error[:2], way) < MIXED_UP_M for way in ways)
    return count


class Floor(Maps):
    def floor(self):
        """Some twenty minutes through all rooms and back, in small pictures."""
        for seed in self.options.seeds:
            name = f"floor_light {seed}, recorded"
            sequence, folder, summary = self.walk_run("floor_light", seed, "recorded")
            self.evaluate(sequence, folder, "--plan", folder / "plan.png")
            self.ate_row(f"{name}, ATE RMSE", summary, 0.08, digits=3)
            self.row(f"{name}, wrong poses at the time", summary["live"]["wrong_poses"], "", 0, digits=0)
            self.row(f"{name}, wrong poses in the end", summary["wrong_poses"], "", digits=0)
            self.wrong_loops(name, sequence, folder)
            self.row(f"{name}, frames with a pose", 100 * summary["frames"]["pose_share"], "%", 95, most=False,
                     digits=1)
            for file, when in (("trajectory_live", "at the time"), ("trajectory", "in the end")):
                self.row(f"{name}, alike rooms mixed up: poses {when}",
                         mixed_up(sequence, folder / f"{file}.txt"), "", 0, digits=0)
            self.loop_counts(name, summary["loops"])

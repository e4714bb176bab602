# SPDX-License-Identifier: BSD-3-Clause
"""A floor of eight rooms, two of them alike: are they taken for each other?"""
import bisect
import json

from bench_maps import Maps
from bench_runs import poses


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
    """Where a simulated camera was, and in which room."""

    def __init__(self, sequence):
        self.rooms = json.loads((sequence / "events.json").read_text())["rooms"]
        found = sorted((float(stamp), pose) for stamp, pose in poses(sequence / "groundtruth.txt").items())
        self.stamps, self.poses = [stamp for stamp, _ in found], [pose for _, pose in found]

    def pose(self, stamp):
        return self.poses[min(bisect.bisect_left(self.stamps, stamp), len(self.poses) - 1)]

    def room(self, place):
        """The room at a place of the world; an empty one between rooms."""
        return next((room for room in self.rooms
                     if all(low <= x <= high for low, x, high in zip(room["low_m"], place, room["high_m"]))), {})


def alike(one, other):
    return bool(one and other) and one != other and (
        one.get("like", one["name"]) == other.get("like", other["name"]))


def mixed_up(sequence, trajectory):
    """How many poses are in a room that is like the one where the camera truly was. Poses are placed in the
    world by the first of them."""
    truth = Truth(sequence)
    told = sorted((float(stamp), pose) for stamp, pose in poses(trajectory).items())
    (at, turn), (true_at, true_turn) = told[0][1], truth.pose(told[0][0])
    q_world_map = product(true_turn, inverse(turn))
    count = 0
    for stamp, (place, _) in told:
        moved = turned(q_world_map, [p - a for p, a in zip(place, at)])
        told_room = truth.room([t + m for t, m in zip(true_at, moved)])
        count += alike(told_room, truth.room(truth.pose(stamp)[0]))
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
                self.row(f"{name}, poses in the other one of two rooms alike, {when}",
                         mixed_up(sequence, folder / f"{file}.txt"), "", 0, digits=0)
            self.loop_counts(name, summary["loops"])

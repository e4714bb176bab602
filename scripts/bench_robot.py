# SPDX-License-Identifier: BSD-3-Clause
"""The robot's other sensors: their gain along bare walls and in falls, and the cost of wrong data."""
import math
import random
import statistics

from bench_falls import Falls
from bench_floor import inverse, product, turned
from bench_runs import poses

MOST_COST = 1.05


def late(rows, seconds):
    return [[f"{float(r[0]) + seconds:.6f}", *r[1:]] for r in rows]


def noisy(rows, sigma_m):
    chance = random.Random(1)
    return [[r[0], *(f"{float(v) + chance.gauss(0, sigma_m):.6f}" for v in r[1:4]), *r[4:]] for r in rows]


def scaled(rows, factor):
    return [[r[0], *(f"{float(v) * factor:.6f}" for v in r[1:4]), *r[4:]] for r in rows]


def jumping(rows, every):
    return [[r[0], f"{float(r[1]) + i // every:.6f}", *r[2:]] for i, r in enumerate(rows)]


def walking_alone(rows):
    start = float(rows[0][0])
    return [[r[0], f"{0.5 * (float(r[0]) - start):.6f}", "0", "0", "0", "0", "0", "1"] for r in rows]


# Odometry of a robot with something wrong.
GARBAGE = {
    "frozen": lambda rows: [[r[0], *rows[0][1:]] for r in rows],
    "twice as far": lambda rows: scaled(rows, 2),
    "in millimetres": lambda rows: scaled(rows, 1000),
    "mirrored": lambda rows: scaled(rows, -1),
    "half a second late": lambda rows: late(rows, 0.5),
    "of another clock": lambda rows: late(rows, -1e6),
    "noise of 0.1 m": lambda rows: noisy(rows, 0.1),
    "jumps of a metre": lambda rows: jumping(rows, 40),
    "walks alone": walking_alone,
    "stops half way": lambda rows: rows[:len(rows) // 2],
}


def tilt_deg(sequence, trajectory):
    """The angle between the vertical of a trajectory and the true one, median over its poses."""
    truth = poses(sequence / "groundtruth.txt")
    angles = []
    for stamp, (_, q) in poses(trajectory).items():
        if stamp in truth:
            up = turned(product(truth[stamp][1], inverse(q)), (0.0, 0.0, 1.0))
            angles.append(math.degrees(math.acos(max(-1.0, min(1.0, up[2])))))
    return statistics.median(angles) if angles else None


class Robot(Falls):
    def sensor_run(self, sequence, name, *arguments):
        status = self.output / f"{sequence.name}_{name}_status.csv"
        return (*self.run(f"{sequence.name}_{name}_run", sequence, "--detector", "recorded", "--save-status", status,
                          *arguments), status)

    def robot(self):
        """Along a bare wall, down some stairs, and through a room, with and without."""
        for seed in self.options.seeds:
            self.robot_corridor(seed)
            self.robot_stairs(seed)
        self.robot_garbage(self.options.seeds[0])

    def with_all(self, sequence):
        return self.sensor_run(sequence, "robot", "--odometry", sequence / "odometry.txt", "--imu",
                               sequence / "imu.csv")

    def robot_corridor(self, seed):
        sequence = self.simulated("corridor_light", seed)
        name = f"corridor_light {seed}"
        alone = self.sensor_run(sequence, "alone")[1]
        self.row(f"{name}, camera alone: false poses at the time", alone["live"]["false_poses"], "", 0, digits=0)
        self.row(f"{name}, camera alone: frames with a pose", 100 * alone["frames"]["pose_share"], "%", digits=1)
        summary = self.with_all(sequence)[1]
        self.row(f"{name}, odometry and IMU: frames with a pose", 100 * summary["frames"]["pose_share"], "%", 99,
                 most=False, digits=2)
        self.ate_row(f"{name}, odometry and IMU: ATE RMSE", summary, 0.05, digits=3)
        self.wrong_rows(f"{name}, odometry and IMU", summary, None)

    def robot_stairs(self, seed):
        sequence = self.simulated("stairs_fall_light", seed)
        alone = self.sensor_run(sequence, "alone")
        for what, (folder, summary, status) in (("camera alone", alone), ("odometry and IMU", self.with_all(sequence))):
            name = f"stairs_fall_light {seed}, {what}"
            self.row(f"{name}: wrong poses at the time", summary["live"]["wrong_poses"], "", 0, digits=0)
            self.row(f"{name}: frames with a pose", 100 * summary["frames"]["pose_share"], "%", digits=1)
            bar = 0.5 if what != "camera alone" else None
            self.row(f"{name}: tilt", tilt_deg(sequence, folder / "trajectory.txt"), "degrees", bar, digits=2)

    def robot_garbage(self, seed):
        sequence = self.simulated("corridor_light", seed)
        alone = self.sensor_run(sequence, "alone")[1]
        rows = [line.split() for line in (sequence / "odometry.txt").read_text().splitlines() if line[0] != "#"]
        for kind, spoil in GARBAGE.items():
            folder = self.output / "garbage" / kind.replace(" ", "_")
            folder.mkdir(parents=True, exist_ok=True)
            (folder / "base_camera.txt").write_text((sequence / "base_camera.txt").read_text())
            (folder / "odometry.txt").write_text("".join(" ".join(row) + "\n" for row in spoil(rows)))
            summary = self.sensor_run(sequence, f"garbage_{folder.name}", "--odometry", folder / "odometry.txt")[1]
            cost = summary["live"]["ate_rmse_m"] / alone["live"]["ate_rmse_m"]
            self.row(f"corridor_light {seed}, odometry {kind}: ATE against none, at the time", cost, "x", MOST_COST,
                     digits=3)
            self.row(f"corridor_light {seed}, odometry {kind}: wrong poses at the time",
                     summary["live"]["wrong_poses"], "", alone["live"]["wrong_poses"], digits=0)

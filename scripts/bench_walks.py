# SPDX-License-Identifier: BSD-3-Clause
"""Simulated walks and falls: where the camera is lost, and whether the chain reports it."""
import csv
import json

from bench_falls import Falls
from bench_report import call
from bench_maps import Maps
from bench_runs import PROGRAMS, note

WALKING_BARS_M = {"walking_static": 0.0015, "walking_xyz": 0.004, "walking_halfsphere": 0.006,
                  "walking_rpy": 0.008}
WALKING_SECONDS = 30


def states(folder):
    """The rows of the table that a run keeps of its frames."""
    with open(folder.parent / "status.csv", newline="") as file:
        return list(csv.DictReader(file))


class Walks(Falls, Maps):
    def check_track(self, name, sequence, folder, summary):
        """Wrong and false poses of a run, by posefusion_evaluate. Draws the plan."""
        plan = folder / "plan.png"
        self.wrong_rows(name, summary)
        return self.evaluate(sequence, folder, "--plan", plan)

    def detectors(self):
        """People as recorded and, where the weights are, as the network finds them."""
        return ("recorded", "network") if self.options.model.exists() else ("recorded",)

    def walk(self):
        self.for_each_run(self.walk_without_loops, self.walk_with_loops)

    def fall(self):
        self.for_each_run(self.fall_without_loops, self.fall_with_loops)

    def for_each_run(self, *parts):
        for people in self.detectors():
            for seed in self.options.seeds:
                for part in parts:
                    part(seed, people)

    def walk_without_loops(self, seed, people):
        name = f"loop_room {seed}, {people}, no loop closing"
        sequence, folder, summary = self.walk_run("loop_room", seed, people, loops=False)
        track = self.check_track(name, sequence, folder, summary)
        self.row(f"{name}, frames with a pose, of those not blurred",
                 100 * track["coverage"]["share_of_sharp"], "%", 99, most=False, digits=2)
        self.ate_row(f"{name}, ATE RMSE", summary, 0.20, digits=3)
        self.row(f"{name}, frames doubtful", summary["frames"]["by_state"].get("doubtful", 0), "",
                 digits=0)

    def walk_with_loops(self, seed, people):
        name = f"loop_room {seed}, {people}"
        sequence, folder, summary = self.walk_run("loop_room", seed, people)
        track = self.check_track(name, sequence, folder, summary)
        self.ate_row(f"{name}, ATE RMSE", summary, 0.05, digits=3)
        self.row(f"{name}, error of the last pose", track["last_m"], "m", 0.04, digits=3)
        self.surface(name, sequence, folder)
        self.wrong_loops(name, sequence, folder)
        self.closer_times(name, summary)
        for count in ("keyframes", "corrections"):
            self.row(f"{name}, loops: {count}", summary["loops"][count], "", digits=0)
        self.loop_counts(name, summary["loops"])

    def fall_without_loops(self, seed, people):
        name = f"fall_short {seed}, {people}, no loop closing"
        sequence, folder, summary = self.walk_run("fall_short", seed, people, loops=False)
        track = self.check_track(name, sequence, folder, summary)
        after = self.after_loss(folder)
        posed = sum(row["has_pose"] == "1" for row in after)
        text = "never lost" if not after else "yes" if posed == 0 else f"{posed} poses after it"
        # A camera that is located again has to be where it is reported.
        stays = bool(after) and posed == 0
        self.fact(f"{name}, lost stays lost", stays or track["false_poses"] == 0, text)

    def fall_with_loops(self, seed, people):
        name = f"fall_short {seed}, {people}"
        sequence, folder, summary = self.walk_run("fall_short", seed, people)
        self.check_track(name, sequence, folder, summary)
        self.ate_row(f"{name}, ATE RMSE, fall included", summary, 0.04, digits=3)
        self.wrong_loops(name, sequence, folder)
        after = self.after_loss(folder)
        posed = [float(row["stamp"]) for row in after if row["has_pose"] == "1"]
        back = posed[0] - float(after[0]["stamp"]) if posed else None
        self.row(f"{name}, from the loss to the next pose", back, "s", digits=2)
        self.row(f"{name}, frames after the loss with a pose", 100 * len(posed) / max(1, len(after)),
                 "%", digits=1)
        self.row(f"{name}, lost frames found of those searched", summary["loops"]["places_found"],
                 f"of {summary['loops']['places_searched']}", digits=0)
        self.fall_rows(name, self.fall_check(sequence, folder.parent / "status.csv", "--map",
                                             folder / "map.pfdb"))

    def told_wrong(self):
        """Five wrong loops that agree with each other, added while loop_room is mapped."""
        for seed in self.options.seeds:
            sequence = self.simulated("loop_room", seed)
            found = {}
            for loops in (0, 5):
                note(f"mapping loop_room {seed} with {loops} wrong loops")
                found[loops] = json.loads(call(PROGRAMS / "posefusion_wrong_loops", sequence,
                                               "--detector", "recorded", "--loops", str(loops),
                                               "--seed", str(seed)))
            wrong = found[5]
            name = f"loop_room {seed}, recorded, five wrong loops told"
            self.row(f"{name}: in the graph at a time", wrong["held_at_a_time"], "", digits=0)
            self.row(f"{name}: in the end", wrong["held_in_the_end"], "", 0, digits=0)
            self.row(f"{name}: ATE RMSE, not refined", wrong["ate_rmse_m"], "m")
            self.row(f"{name}: that against none told", wrong["ate_rmse_m"] / found[0]["ate_rmse_m"],
                     "x", 1.1, digits=2)

    def come_back(self):
        """How soon a camera is found in a map made before: at its start, and after a fall."""
        for seed in self.options.seeds:
            sequence, folder, _ = self.walk_run("loop_room", seed, "recorded")
            note(f"looking for the camera in the map of loop_room {seed}")
            found = json.loads(call(PROGRAMS / "posefusion_return_check", sequence, "--map",
                                    folder / "map.pfdb"))
            for what, median, worst in (("starts", None, 1.0), ("falls", 0.5, 2.0)):
                name, part = f"loop_room {seed}, {what} in its map", found[what]
                self.row(f"{name}: found", part["found"], f"of {part['trials']}", part["trials"],
                         most=False, digits=0)
                self.row(f"{name}: wrong", part["wrong"], "", 0, digits=0)
                self.row(f"{name}: time to tracking, median", part["median_s"], "s", median, digits=2)
                self.row(f"{name}: time to tracking, worst", part["worst_s"], "s", worst, digits=2)

    @staticmethod
    def after_loss(folder):
        """The frames from the first that is lost on."""
        rows = states(folder)
        lost = next((i for i, row in enumerate(rows) if row["state"] == "lost"), len(rows))
        return rows[lost:]

    def walking(self):
        for scenario, bar in WALKING_BARS_M.items():
            for seed in self.options.seeds:
                name = f"{scenario} {seed}, network"
                sequence, folder, summary = self.walk_run(scenario, seed, "network", WALKING_SECONDS)
                self.check_track(name, sequence, folder, summary)
                self.ate_row(f"{name}, ATE RMSE", summary, bar)
                self.row(f"{name}, frames lost", summary["frames"]["lost"], "", 0, digits=0)

    def covariance(self):
        runs = [(scenario, seed, "network", WALKING_SECONDS) for scenario in WALKING_BARS_M
                for seed in self.options.seeds]
        runs += [("loop_room", seed, "recorded", None) for seed in self.options.seeds]
        for scenario, seed, people, seconds in runs:
            sequence, folder, _ = self.walk_run(scenario, seed, people, seconds, loops=False)
            share = self.evaluate("covariance", sequence, folder.parent / "status.csv")
            name = f"{scenario} {seed}, motion's true error within 3 sigma"
            self.row(name, 100 * share["within_3_sigma"], "%", 90, most=False, digits=1)
            self.nees_rows(f"{scenario} {seed}", share["nees_5_s"], 85 if scenario == "loop_room" else None)

    def nees_rows(self, name, nees, bar):
        """Both ways: whether errors of motions over a second are as large as reported."""
        self.row(f"{name}, NEES of motions over 1 s, means of five within their 95 % band",
                 100 * nees["inside"], "%", bar, most=False, digits=1)
        self.fact(f"{name}, the same, below (too cautious), above (too sure); mean, which should be 6", None,
                  f"{100 * nees['too_low']:.1f}, {100 * nees['too_high']:.1f} %; {nees['mean']:.2f}")

# SPDX-License-Identifier: BSD-3-Clause
"""Maps against the true surface, with people that come and go, and of long walks with their ferns and loops."""
import math

from bench_runs import Runs, poses

MODES = ("pfh", "elastic", "posefusion")
LONG_FRAMES_PER_SECOND = 15
SAME_PLACE_M, SAME_PLACE_DEG = 0.10, 5.0


def is_far(one, other):
    """Whether two poses are not of the same place."""
    turn = abs(sum(a * b for a, b in zip(one[1], other[1])))
    degrees = 2 * math.degrees(math.acos(min(1.0, turn)))
    return math.dist(one[0], other[0]) > SAME_PLACE_M or degrees > SAME_PLACE_DEG


class Maps(Runs):
    def surface(self, name, sequence, folder):
        """Rows of a map against the true surface of its room."""
        found = self.evaluate("surface", folder, sequence)
        self.row(f"{name}, surfels to the true surface, median", 1e3 * found["median_m"], "mm", 20, digits=1)
        self.row(f"{name}, the same, 95 %", 1e3 * found["p95_m"], "mm", 60, digits=1)
        self.row(f"{name}, surfels in two layers of one surface", 100 * found["two_layers"], "%", 2, digits=2)

    def wrong_loops(self, name, sequence, folder, barred=True):
        """Whether the loops that corrected the map are true."""
        found = self.evaluate("loops", folder / "map.pfdb", sequence)
        self.row(f"{name}, loops that hold and are wrong", found["wrong"], f"of {found['loops']}",
                 0 if barred else None, digits=0)

    def closer_times(self, name, summary):
        times = summary["stages"]
        self.row(f"{name}, loops on the tracking thread, 99.9 %", times["loop_closing"]["p999_ms"], "ms", 2)
        self.row(f"{name}, the same, most", times["loop_closing"]["most_ms"], "ms", digits=1)
        self.row(f"{name}, verification of a keyframe beside it, median",
                 times["loop_verification"]["median_ms"], "ms", 100, digits=1)

    def loop_counts(self, name, loops):
        """A row of Table IV of the paper."""
        refused = ", ".join(f"{count} {why}" for why, count in loops["refused"].items() if count > 0)
        self.fact(f"{name}: ferns stored (not static), loops accepted (of them local); refused", None,
                  f"{loops['ferns']} ({loops['ferns_not_static']}), {loops['accepted']} "
                  f"({loops['accepted_local']}); {refused or 'none'}")

    def modes(self):
        """Table IV: ferns and loops of the three modes, people recorded."""
        for seed in self.options.seeds:
            for mode in MODES:
                sequence = self.simulated("loop_room", seed)
                folder, summary = self.run(f"{sequence.name}_{mode}_run", sequence, "--detector", "recorded",
                                           "--mode", mode)
                name = f"loop_room {seed}, {mode}"
                self.ate_row(f"{name}, ATE RMSE", summary, digits=3)
                self.loop_counts(name, summary["loops"])

    def long(self):
        """The paper's walks at their whole length: hours to render, so only behind --long."""
        for scenario in ("hrpslam1", "hrpslam2"):
            sequence = self.simulated(scenario, self.options.seeds[0], None, "--set",
                                      f"fps={LONG_FRAMES_PER_SECOND}")
            for mode in MODES:
                name = f"{scenario}, {mode}"
                status = self.output / f"{sequence.name}_{mode}_status.csv"
                folder, summary = self.run(f"{sequence.name}_{mode}_run", sequence, "--detector", "recorded",
                                           "--mode", mode, "--save-status", status)
                # The bars are for the default mode.
                self.long_rows(name, sequence, folder, summary, barred=mode == "pfh")
                self.known_rows(name, sequence, folder, status, barred=mode == "pfh")
                self.loop_counts(name, summary["loops"])

    def long_rows(self, name, sequence, folder, summary, barred):
        def bar(value):
            return value if barred else None
        track = self.evaluate(sequence, folder, "--plan", folder / "plan.png")
        self.ate_row(f"{name}, ATE RMSE", summary, bar(0.06), digits=3)
        self.row(f"{name}, frames with a pose, of those not blurred",
                 100 * track["coverage"]["share_of_sharp"], "%", digits=2)
        self.wrong_rows(name, summary, bar(0))
        self.wrong_loops(name, sequence, folder, barred)
        minutes = summary["by_minute"]
        for part, what in (("median_ms", "median"), ("p99_ms", "99 %")):
            growth = minutes[-1][part] / minutes[1][part] if len(minutes) > 2 and minutes[1][part] > 0 else None
            self.row(f"{name}, a frame of the last minute against the second, loops and all, {what}", growth,
                     "x", bar(1.1) if growth else None, digits=2)
        self.row(f"{name}, peak memory", summary["peak_memory_mb"], "MB", bar(1500), digits=0)

    def known_rows(self, name, sequence, folder, status, barred):
        """Share of frames with a pose, of those that truly see mapped surfaces."""
        known = self.evaluate("known", folder, sequence, "--status", status)
        self.row(f"{name}, sharp frames that see what was mapped", known["known"],
                 f"of {known['sharp']}", digits=0)
        self.row(f"{name}, of them with a pose at the time", 100 * known["share_posed"], "%",
                 97 if barred else None, most=False, digits=2)
        self.row(f"{name}, with a pose in the end", 100 * known["share_posed_in_the_end"], "%",
                 digits=2)

    def visitors(self):
        """A map made with people in view is found again without them, and the reverse."""
        crowded = self.simulated("walking_xyz", 1, 5, "--start", "6")
        empty = self.simulated("walking_xyz", 1, 5, "--start", "6", "--set", "people=[]")
        for made, seen, name in ((crowded, empty, "map made among people, found without them"),
                                 (empty, crowded, "map made without people, found among them")):
            there, _ = self.run(f"{made.name}_map", made, "--detector", "recorded" if made == crowded else "none")
            again, _ = self.run(f"{seen.name}_again", seen, "--detector",
                                "recorded" if seen == crowded else "none", "--map", there / "map.pfdb",
                                "--localize-only")
            known, found = poses(there / "trajectory.txt"), poses(again / "trajectory.txt")
            stamps = sorted(float(stamp) for stamp in found)
            begin = min(float(stamp) for stamp in known)
            self.row(f"{name}: time until found", stamps[0] - begin if stamps else None, "s", 1, digits=2)
            self.row(f"{name}: frames with a pose", len(found), f"of {len(known)}", digits=0)
            far = sum(1 for stamp in found if stamp in known and is_far(found[stamp], known[stamp]))
            self.row(f"{name}: wrong", far, "", 0, digits=0)

# SPDX-License-Identifier: BSD-3-Clause
"""What becomes of maps: against the true surface, killed while written, people who come and go, and
the long walks with their ferns and loops."""
import math
import random
import shutil
import subprocess
import time

from bench_report import Failed, call
from bench_runs import PROGRAMS, Runs, note

MODES = ("pfh", "elastic", "posefusion")
LONG_FRAMES_PER_SECOND = 15
KILLS, KILL_SEED = 50, 1
NO_MAP_YET = "its writer ended before the first write"
JOURNAL, PARTIAL_MAP = "trajectory.partial.txt", "map.partial.pfdb"
SAME_PLACE_M, SAME_PLACE_DEG = 0.10, 5.0


def poses(path):
    """{stamp: (x y z, quaternion)} of a trajectory file."""
    rows = (line.split() for line in path.read_text().splitlines() if not line.startswith("#"))
    return {r[0]: ([float(v) for v in r[1:4]], [float(v) for v in r[4:8]]) for r in rows if len(r) == 8}


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
        """Whether the loops that the map was corrected by are true."""
        found = self.evaluate("loops", folder / "map.pfdb", sequence)
        self.row(f"{name}, loops that hold and are wrong", found["wrong"], f"of {found['loops']}",
                 0 if barred else None, digits=0)

    def closer_times(self, name, summary):
        times = summary["stages"]
        self.row(f"{name}, loop closer on the tracking thread, median",
                 times["loop_closing"]["median_ms"], "ms", 1, digits=3)
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
                self.row(f"{name}, ATE RMSE", summary.get("ate_rmse_m"), "m", digits=3)
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
        self.row(f"{name}, ATE RMSE", track["ate_m"]["rmse"], "m", bar(0.06), digits=3)
        self.row(f"{name}, frames with a pose, of those not blurred",
                 100 * track["coverage"]["share_of_sharp"], "%", digits=2)
        self.row(f"{name}, wrong poses", track["wrong_poses"], "", bar(0), digits=0)
        self.wrong_loops(name, sequence, folder, barred)
        minutes = summary["median_ms_by_minute"]
        growth = minutes[-1] / minutes[1] if len(minutes) > 2 and minutes[1] > 0 else None
        self.row(f"{name}, a frame of the last minute against the second", growth, "x",
                 bar(1.15) if growth else None, digits=2)
        self.row(f"{name}, peak memory", summary["peak_memory_mb"], "MB", bar(1500), digits=0)

    def known_rows(self, name, sequence, folder, status, barred):
        """Frames with a pose, of those that truly see what was mapped."""
        known = self.evaluate("known", folder, sequence, "--status", status)
        self.row(f"{name}, sharp frames that see what was mapped", known["known"],
                 f"of {known['sharp']}", digits=0)
        self.row(f"{name}, of them with a pose at the time", 100 * known["share_posed"], "%",
                 97 if barred else None, most=False, digits=2)
        self.row(f"{name}, with a pose in the end", 100 * known["share_posed_in_the_end"], "%",
                 digits=2)

    def kills(self):
        """kill -9 at random moments while a map is made: what of it is lost?"""
        sequence = self.simulated("walking_xyz", 1, 5, "--start", "6")
        chance = random.Random(KILL_SEED)
        frames = sum(1 for line in (sequence / "depth.txt").read_text().splitlines() if line[0] != "#")
        note(f"killing {KILLS} runs")
        ends = [self.kill_one(sequence, chance.randint(1, frames - 10), chance.uniform(0, 0.2))
                for _ in range(KILLS)]
        lost, recorded = (sorted(times) for times in list(zip(*ends))[1:])
        early = sum(1 for state, _, _ in ends if state == "empty")
        whole = early + sum(1 for state, _, _ in ends if state == "whole")
        self.row(f"killed while mapping: files that load ({early}: before the first write, and say so)", whole,
                 f"of {KILLS}", KILLS, most=False, digits=0)
        self.row("killed while mapping: work told and lost, median", lost[KILLS // 2], "s", digits=2)
        self.row("killed while mapping: work told and lost, worst", lost[-1], "s", 1, digits=2)
        self.row("killed while mapping: of the recording, worst", recorded[-1], "s", digits=2)

    def kill_one(self, sequence, poses_before, wait_s):
        """What the map file is of a run killed so long after so many poses (whole, empty, broken), and
        how much is lost (s): from when it told the last pose that is in the file to when it told the
        last of all; and the same by the stamps of the two."""
        folder = self.output / "killed"
        shutil.rmtree(folder, ignore_errors=True)
        run = subprocess.Popen([str(PROGRAMS / "posefusion_run"), str(sequence), "--output", str(folder),
                                "--detector", "recorded"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        told, stop = {}, None  # when each pose was told first; when to kill
        while run.poll() is None and (stop is None or time.monotonic() < stop):
            journal = folder / JOURNAL
            for stamp in poses(journal) if journal.exists() else ():
                told.setdefault(stamp, time.monotonic())
            if stop is None and len(told) >= poses_before:
                stop = time.monotonic() + wait_s
            time.sleep(0.005)
        if run.poll() is not None:
            raise Failed(f"posefusion_run ended before it was killed (code {run.returncode})")
        run.kill()
        run.wait()
        told_last = list(poses(folder / JOURNAL))[-1]
        end = told.get(told_last, time.monotonic())
        try:
            call(PROGRAMS / "posefusion_map", "check", folder / PARTIAL_MAP)
            info = call(PROGRAMS / "posefusion_map", "info", folder / PARTIAL_MAP)
        except Failed as error:
            print(f"  {error}")
            return ("empty" if NO_MAP_YET in str(error) else "broken", end - min(told.values()),
                    float(told_last) - float(min(told)))
        last = next(line.split()[-1] for line in info.splitlines() if line.startswith("time "))
        return "whole", max(0.0, end - told[last]), max(0.0, float(told_last) - float(last))

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

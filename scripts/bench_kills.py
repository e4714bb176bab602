# SPDX-License-Identifier: BSD-3-Clause
"""The part `kills` of scripts/bench: kill -9 at random moments of a run, from its start to the renaming of its folder,
while a map is made, continued, or written on in place. Which files load, and what do they lack?"""
import random
import shutil
import subprocess
import time

from bench_report import Failed, call
from bench_runs import PROGRAMS, Runs, newest, note, poses

KILLS, KILL_SEED = 102, 1
LATE = 1.05  # of the time of a whole run: the last ones end by themselves
NO_MAP_YET = "its writer ended before the first write"
JOURNAL, PARTIAL_MAP, MAP = "trajectory.partial.txt", "map.partial.pfdb", "map.pfdb"


def run_folder(output):
    """Of the one run below a folder; None before there is one."""
    folders = [path for path in output.glob("*") if path.is_dir() and not path.is_symlink()]
    return folders[0] if folders else None


def frames_in(map_file):
    """How many frames with a pose a map holds."""
    info = call(PROGRAMS / "posefusion_map", "info", map_file)
    return next(int(line.split()[1]) for line in info.splitlines() if line.startswith("frames "))


class Kill:
    """One run that is killed, and the files that it leaves."""
    def __init__(self, sequence, output, arguments, map_file, loaded):
        self.output, self.map_file, self.loaded = output, map_file, loaded
        self.reported = {}  # when each pose was first reported
        shutil.rmtree(output, ignore_errors=True)
        self.run = subprocess.Popen([str(PROGRAMS / "posefusion_run"), str(sequence), "--output", str(output),
                                     "--detector", "recorded", *map(str, arguments)],
                                    stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)

    def kill_after(self, seconds):
        stop = time.monotonic() + seconds
        while self.run.poll() is None and time.monotonic() < stop:
            self.listen()
            time.sleep(0.005)
        self.run.kill()
        self.run.wait()
        self.listen()

    def listen(self):
        folder = run_folder(self.output)
        journal = folder and folder / JOURNAL
        try:
            for stamp in poses(journal) if journal and journal.exists() else ():
                self.reported.setdefault(stamp, time.monotonic())
        except OSError:
            pass  # renamed meanwhile

    def phase(self):
        folder = run_folder(self.output)
        if folder is None:
            return "start"
        if self.run.returncode == 0:
            return "ended"
        if folder.suffix != ".partial" or (folder / "trajectory.txt").exists():
            return "end"
        return "mapping" if self.reported else "start"

    def map_found(self):
        """The map file that the run left; None where there is none yet."""
        if self.map_file:
            return self.map_file
        folder = run_folder(self.output)
        found = [folder / name for name in (MAP, PARTIAL_MAP) if folder and (folder / name).exists()]
        return found[0] if found else None

    def lost_s(self):
        """Seconds between the last pose in the map and the last one reported. Throws Failed where the map does not
        load."""
        if not self.reported:
            if self.map_file:
                call(PROGRAMS / "posefusion_map", "check", self.map_file)
            return 0.0
        last, first = max(self.reported.values()), min(self.reported.values())
        found = self.map_found()
        if found is None:
            return last - first
        try:
            call(PROGRAMS / "posefusion_map", "check", found)
        except Failed as error:
            if NO_MAP_YET in str(error):
                return last - first
            raise
        # Poses are reported and written in the same order, after those of a map that is continued.
        saved = frames_in(found) - self.loaded
        times = sorted(self.reported.values())
        return last - first if saved <= 0 else last - times[min(saved, len(times)) - 1]


class Kills(Runs):
    def kills(self):
        sequence = self.simulated("walking_xyz", 1, 5, "--start", "6")
        made, _ = self.run(f"{sequence.name}_for_kills", sequence, "--detector", "recorded")
        chance = random.Random(KILL_SEED)
        note(f"killing {KILLS} runs")
        ends = []
        for mode in ("a new map", "on from a map", "in place"):
            whole_s = self.whole_run(sequence, made / MAP, mode)
            ends += [self.kill_one(sequence, made / MAP, mode, chance.uniform(0, LATE * whole_s))
                     for _ in range(KILLS // 3)]
        self.kill_rows(ends)

    def begin(self, sequence, source, mode):
        output, copy = self.output / "killed", self.output / "killed.pfdb"
        for leftover in self.output.glob("killed.pfdb*"):
            leftover.unlink()
        shutil.copyfile(source, copy)
        arguments = {"a new map": (), "on from a map": ("--map", copy),
                     "in place": ("--map", copy, "--continue")}[mode]
        return Kill(sequence, output, arguments, copy if mode == "in place" else None,
                    frames_in(copy) if arguments else 0)

    def whole_run(self, sequence, source, mode):
        """Seconds that a run takes without being killed."""
        begin = time.monotonic()
        run = self.begin(sequence, source, mode)
        if run.run.wait() != 0:
            raise Failed(f"posefusion_run, {mode}, gave {run.run.returncode}")
        return time.monotonic() - begin

    def kill_one(self, sequence, source, mode, seconds):
        """(phase, lost seconds or None where a map does not load)."""
        run = self.begin(sequence, source, mode)
        run.kill_after(seconds)
        try:
            lost = run.lost_s()
            if run.phase() == "ended":
                call(PROGRAMS / "posefusion_map", "check",
                     run.map_file or newest(run.output) / MAP)
        except Failed as error:
            print(f"  {mode}, killed after {seconds:.2f} s: {error}")
            lost = None
        return run.phase(), lost

    def kill_rows(self, ends):
        phases = {phase: sum(1 for p, _ in ends if p == phase) for phase, _ in ends}
        lost = sorted(l for _, l in ends if l is not None)
        self.row("killed: maps that load (" + ", ".join(f"{n} at {p}" for p, n in sorted(phases.items())) + ")",
                 len(lost), f"of {len(ends)}", len(ends), most=False, digits=0)
        self.row("killed: work told and lost, median", lost[len(lost) // 2], "s", digits=2)
        self.row("killed: work told and lost, worst", lost[-1], "s", 1, digits=2)

# SPDX-License-Identifier: BSD-3-Clause
"""The part `hours` of scripts/bench: eight hours in one room. A small recording is walked there and back
again and again with stamps that go on; neither memory nor the time of a frame nor the file may grow."""
import bisect
import json
import re
import shutil
import statistics
import subprocess
import time

from bench_report import Failed
from bench_ros import rows_of, there_and_back, turning
from bench_runs import PROGRAMS, Runs, newest, note
from bench_soak import resident_mb

RATE_HZ = 15
FRAMES = 500_000  # 9 hours
SMALL = ("--set", "camera.width=160", "--set", "camera.height=120", "--set", "depth.disparity_steps=32",
         "--set", "depth.lateral=0.25", "--set", f"fps={RATE_HZ}", "--set", "color.motion_blur=false",
         "--set", "color.samples=1")
HOURS = 8
LOOK_S = 5
START_S = 1.0


def walked_truth(source, folder, frames):
    """The truth of there_and_back(): of each frame that of its depth picture."""
    truth = rows_of(source / "groundtruth.txt")
    stamps = [float(row[0]) for row in truth]
    seen = []
    for row in rows_of(source / "associations.txt"):
        at = min(bisect.bisect(stamps, float(row[2])), len(stamps) - 1)
        seen.append(min(truth[max(at - 1, 0)], truth[at], key=lambda t: abs(float(t[0]) - float(row[2]))))
    with open(folder / "groundtruth.txt", "w", encoding="ascii") as out:
        for i in range(frames):
            row = seen[turning(i, len(seen))]
            out.write(" ".join([f"{START_S + i / RATE_HZ:.6f}", *row[1:]]) + "\n")


def frames_done(log):
    done = re.findall(r"(\d+) of \d+ frames", log.read_text(errors="replace")[-400:])
    return int(done[-1]) if done else 0


class Hours(Runs):
    def hours(self):
        frames = int(self.options.duration * RATE_HZ) if self.options.duration else FRAMES
        # The whole walk, however short the hours are for a try.
        source = self.output / f"hours_{self.options.seeds[0]}_once"
        if not (source / "groundtruth.txt").exists():
            note("simulating the walk")
            shutil.rmtree(source, ignore_errors=True)
            subprocess.run([PROGRAMS / "posefusion_simulate", "loop_room", "--seed", str(self.options.seeds[0]),
                            *SMALL, "--output", source], check=True, capture_output=True)
        sequence = self.output / "hours_walk"
        there_and_back(source, sequence, frames, RATE_HZ, START_S)
        walked_truth(source, sequence, frames)
        self.hours_rows(frames, *self.watched_run(sequence, frames))

    def watched_run(self, sequence, frames):
        """(summary, [(frames done, memory, size of the map's file)])."""
        folder, log = self.output / "hours_run", self.output / "hours_run.log"
        shutil.rmtree(folder, ignore_errors=True)
        note(f"walking for {frames} frames")
        seen = []
        with open(log, "w", encoding="ascii") as out:
            run = subprocess.Popen([PROGRAMS / "posefusion_run", sequence, "--output", folder, "--detector",
                                    "embedded"], stdout=out, stderr=out)
            while run.poll() is None:
                time.sleep(LOOK_S)
                done = frames_done(log)
                if run.poll() is None and 0 < done < 0.99 * frames:  # what refines the map in the end is no walk
                    files = [p.stat().st_size for p in folder.glob("*/map.pfdb*")]
                    seen.append((done, resident_mb(run.pid), sum(files) / 1e6))
        if run.returncode != 0:
            raise Failed(f"the run ended with {run.returncode}: {log.read_text()[-500:]}")
        return json.loads((newest(folder) / "summary.json").read_text()), seen

    def hours_rows(self, frames, summary, seen):
        first = [row for row in seen if row[0] >= frames / HOURS]
        if len(first) < 2:
            raise Failed("too short to measure growth")
        self.row(f"{frames} frames in one room, memory after the first of {HOURS} parts", first[0][1], "MB", digits=0)
        self.row("the same, memory in the end against that", seen[-1][1] / first[0][1], "x", 1.1, digits=2)
        self.row("the same, the map's file in the end against that", seen[-1][2] / first[0][2], "x", 1.1, digits=2)
        minutes = summary["by_minute"]
        part = max(len(minutes) // HOURS, 2)
        for what, key in (("median", "median_ms"), ("99 %", "p99_ms")):
            early = statistics.mean(minute[key] for minute in minutes[1:part])
            late = statistics.mean(minute[key] for minute in minutes[-part:])
            self.row(f"the same, a frame of the last part against the first, {what}", late / early, "x", 1.1, digits=2)
        self.ate_row("the same, ATE RMSE", summary)
        self.wrong_rows("the same", summary)

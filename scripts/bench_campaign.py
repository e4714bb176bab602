# SPDX-License-Identifier: BSD-3-Clause
"""The part `campaign` of scripts/bench: 60 small simulated recordings by scripts/campaign, killed twice and continued,
against runs one after the other."""
import os
import resource
import shutil
import signal
import subprocess
import sys
import time

from bench_hours import SMALL
from bench_report import Failed, call
from bench_runs import PROGRAMS, ROOT, Runs, newest, note

RECORDINGS = 60
SECONDS = 4
SCENARIO = "box_walker"
FILES = ("trajectory.txt", "trajectory_live.txt", "map.ply")
CORES = 2
LEAST_BUSY = 0.9
PATIENCE_S = 7200


def processor_s():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


class Campaign(Runs):
    def campaign(self):
        if not shutil.which("snakemake"):
            return self.fact("campaign: not measured", None, "no program snakemake is installed")
        folder = self.output / "campaign"
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True)
        file = folder / "small.yaml"
        file.write_text(f"recordings:\n- scenario: {SCENARIO}\n  seeds: {list(range(1, RECORDINGS + 1))}\n"
                        f"  duration_s: {self.options.duration or SECONDS}\n  arguments: {' '.join(SMALL)}\n"
                        "settings: {small: ''}\n")
        command = [sys.executable, ROOT / "scripts" / "campaign", file, "--no-build", "--cores", str(CORES), "--output",
                   folder / "out"]
        for share in (3, 1.5):
            self.campaign_killed(command, folder / "out", int(RECORDINGS / share))
        note("a campaign to its end")
        there, began, used = len(done(folder / "out")), time.monotonic(), processor_s()
        call(*command)
        seconds, used = time.monotonic() - began, processor_s() - used
        self.row("campaign: recordings left after the second kill", RECORDINGS - there, "", digits=0)
        self.row(f"campaign: share of {CORES} cores that it used from there on", used / (CORES * seconds), "", LEAST_BUSY,
                 most=False, digits=2)
        self.row("the same, processes that waited for the cores besides (load)", os.getloadavg()[0], "", digits=1)
        self.campaign_bytes(folder / "out")

    @staticmethod
    def campaign_killed(command, output, runs):
        note(f"a campaign, killed after {runs} runs")
        with open(output.with_name("killed.log"), "a", encoding="utf-8") as log:
            process = subprocess.Popen([str(word) for word in command], stdout=log, stderr=log, start_new_session=True)
        end = time.monotonic() + PATIENCE_S
        while len(done(output)) < runs:
            if process.poll() is not None or time.monotonic() > end:
                raise Failed(f"campaign: {output.with_name('killed.log').read_text()[-500:]}")
            time.sleep(0.05)
        os.killpg(process.pid, signal.SIGKILL)
        process.wait()

    def campaign_bytes(self, output):
        """Each recording once more, one after the other."""
        other = []
        note("the same runs one after the other")
        for name in sorted(path.name for path in (output / "recordings").iterdir()):
            folder = output.with_name("by_hand") / name
            call(PROGRAMS / "posefusion_run", output / "recordings" / name, "--output", folder)
            other += [f"{name}/{file}" for file in FILES
                      if (newest(folder) / file).read_bytes() != (output / "runs" / name / "small" / file).read_bytes()]
        self.row("campaign: runs compared with runs one after the other", len(done(output)), "", RECORDINGS, most=False,
                 digits=0)
        self.row("campaign: files that differ from theirs", len(other), "", 0, digits=0)


def done(output):
    return list(output.glob("figures/*/*.json"))

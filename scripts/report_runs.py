# SPDX-License-Identifier: BSD-3-Clause
"""The runs of a report, each done once: earlier results are kept, failed runs are tried again."""
import hashlib
import json
import os
import pathlib
import platform
import shutil
import subprocess
import sys
import time

from bench_report import Failed, call
from bench_runs import PROGRAMS, ROOT, newest
from report_measure import figures_of, figures_of_other


def commit():
    """Of the sources; "-dirty" where they have been changed since."""
    done = subprocess.run(["git", "-C", str(ROOT), "describe", "--always", "--dirty", "--abbrev=10"],
                          stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    return done.stdout.strip() or "unknown"


def build_of():
    """Identifies the programs of a run: the commit, and the programs themselves."""
    digest = hashlib.sha256()
    for path in (PROGRAMS / "posefusion_run", PROGRAMS.parent / "libposefusion_core.so"):
        if path.is_file():
            digest.update(path.read_bytes())
    return f"{commit()} {digest.hexdigest()[:10]}"


def machine():
    model = ""
    try:
        lines = pathlib.Path("/proc/cpuinfo").read_text().splitlines()
        model = next((line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")), "")
    except OSError:
        pass
    return f"{model or platform.machine()}, {os.cpu_count()} cores, {platform.system()} {platform.release()}"


class Progress:
    """Prints progress on stderr, with the remaining time by the frames so far."""

    def __init__(self, total):
        self.total, self.done, self.ran, self.ran_s = total, 0, 0, 0.0

    def begin(self, what):
        left = ""
        if self.ran > 0:
            minutes = self.ran_s / self.ran * (self.total - self.done) / 60
            left = f", about {minutes:.0f} min left" if minutes >= 1 else ", less than a minute left"
        print(f"[{self.done + 1}/{self.total}] {what}{left}", file=sys.stderr, flush=True)

    def end(self, seconds=None):
        """`seconds`: of a run that was done now, not kept."""
        self.done += 1
        if seconds is not None:
            self.ran, self.ran_s = self.ran + 1, self.ran_s + seconds


def kept(file, key):
    try:
        record = json.loads(file.read_text())
    except (OSError, ValueError):
        return None
    return record.get("figures") if record.get("key") == key else None


def keep(file, key, figures):
    temporary = file.with_name(file.name + ".part")
    temporary.write_text(json.dumps({"key": key, "figures": figures}, indent=1))
    temporary.replace(file)


class ModeRuns:
    def __init__(self, output, arguments):
        self.output, self.arguments, self.build = output, list(arguments), build_of()
        self.prints = {}

    def folder(self, sequence, mode, number):
        return self.output / "runs" / sequence.key / f"{mode}_{number}"

    def key(self, sequence, mode):
        if sequence.path not in self.prints:
            self.prints[sequence.path] = sequence.fingerprint()
        return {"build": self.build, "sequence": self.prints[sequence.path], "mode": mode,
                "arguments": self.arguments}

    def get(self, sequence, mode, number, progress):
        """Figures of a run, or {"failed": why}."""
        folder = self.folder(sequence, mode, number)
        file, key = folder / "figures.json", self.key(sequence, mode)
        progress.begin(f"{sequence.heading}, {mode}")
        figures = kept(file, key)
        if figures is not None:
            progress.end()
            return figures
        start = time.monotonic()
        try:
            figures = self.run(sequence, mode, folder)
            keep(file, key, figures)
        except (Failed, OSError, LookupError, ValueError) as error:
            figures = {"failed": str(error)}
            print(f"  failed: {error}", file=sys.stderr, flush=True)
        progress.end(time.monotonic() - start)
        return figures

    def run(self, sequence, mode, folder):
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True)
        call(PROGRAMS / "posefusion_run", sequence.path, "--output", folder, "--mode", mode, *self.arguments)
        return figures_of(sequence, newest(folder).resolve())


def other_systems(folder):
    return sorted(path.name for path in folder.iterdir() if path.is_dir()) if folder else []


def other(folder, system, sequence):
    """Figures of a trajectory DIR/SYSTEM/SEQUENCE.txt; {"failed": why} where there is none."""
    file = folder / system / f"{sequence.name}.txt"
    if not file.is_file():
        return {"failed": f"no {system}/{file.name}"}
    try:
        return figures_of_other(sequence, file)
    except (Failed, OSError, LookupError, ValueError) as error:
        return {"failed": str(error)}

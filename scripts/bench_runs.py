# SPDX-License-Identifier: BSD-3-Clause
"""Runs of the chain and the sequences that they are made from, each done once."""
import hashlib
import json
import pathlib
import shutil
import sys

from bench_report import Report, call

ROOT = pathlib.Path(__file__).resolve().parent.parent
PROGRAMS = ROOT / "devel" / "lib" / "posefusion"

# The simulator's people are made of these too.
BODY_SOURCES = ("block_lattice.cpp", "polygonise.cpp", "surface_nets.cpp")


def note(text):
    print(f"  {text} ...", file=sys.stderr)


def fingerprint(scenario, arguments):
    """Of all that a simulated sequence is made from: scenario, simulator and arguments. Not of the
    program's age: a build that changes no simulator costs no eight minutes of rendering."""
    digest = hashlib.sha256("\n".join(arguments).encode())
    sources = sorted(p for p in (ROOT / "src" / "simulator").rglob("*") if p.is_file())
    sources += [ROOT / "src" / "mesh" / name for name in BODY_SOURCES]
    scenarios = sorted((ROOT / "config" / "scenarios").glob("*.yaml"))
    by_name = {path.stem: path.read_text() for path in scenarios}
    for path in sources:
        digest.update(path.name.encode() + path.read_bytes())
    while scenario in by_name:  # a scenario may start from another one
        text = by_name.pop(scenario)
        digest.update(text.encode())
        bases = [line.split(":", 1)[1].strip() for line in text.splitlines() if line.startswith("base:")]
        scenario = bases[0] if bases else ""
    return digest.hexdigest()


def newest(folder):
    """Where the results of a run lie; older builds wrote into the folder itself."""
    latest = folder / "latest"
    return latest if latest.is_dir() else folder


def poses(path):
    """{stamp: (x y z, quaternion)} of a trajectory file."""
    rows = (line.split() for line in path.read_text().splitlines() if not line.startswith("#"))
    return {r[0]: ([float(v) for v in r[1:4]], [float(v) for v in r[4:8]]) for r in rows if len(r) == 8}


def plain(argument):
    """An argument as part of a folder's name."""
    return "".join(c for c in argument if c.isalnum() or c == "_")


class Runs(Report):
    def __init__(self, options):
        super().__init__()
        self.options = options
        self.runs = {}
        self.output = options.output
        self.output.mkdir(parents=True, exist_ok=True)

    def run(self, name, source, *arguments):
        """(output folder, summary) of a run of the offline chain."""
        if name not in self.runs:
            note(f"running {name}")
            folder = self.output / name
            shutil.rmtree(folder, ignore_errors=True)
            call(PROGRAMS / "posefusion_run", source, "--output", folder, *arguments)
            self.runs[name] = newest(folder), json.loads((newest(folder) / "summary.json").read_text())
        return self.runs[name]

    def network_arguments(self):
        return "--detector", "network", "--model", self.options.model

    def network(self, name, sequence, *arguments):
        return self.run(name, self.options.data / sequence, *self.network_arguments(), "--save-masks",
                        *arguments)

    def evaluate(self, *arguments):
        return json.loads(call(PROGRAMS / "posefusion_evaluate", *arguments, "--json"))

    def simulated(self, scenario, seed, duration=None, *more, name=""):
        """A simulated sequence: that of --sequences where it is there, or made, and kept until
        what it is made from changes. `duration` in seconds; None: the scenario's own. `more`:
        further arguments of the simulator, which are part of the name where none is given."""
        name = name or "_".join([scenario, str(seed), *(a for a in map(plain, more) if a)])
        given = self.options.sequences and self.options.sequences / name
        if given and given.is_dir():
            return given
        duration = self.options.duration or duration
        arguments = [scenario, "--seed", str(seed), *more]
        if duration:
            arguments += ["--duration", str(duration)]
        folder = self.output / (name + (f"_{duration:g}s" if duration else ""))
        marker, wanted = folder / "made_from", fingerprint(scenario, arguments)
        if marker.exists() and marker.read_text() == wanted:
            return folder
        note(f"simulating {folder.name}")
        shutil.rmtree(folder, ignore_errors=True)
        call(PROGRAMS / "posefusion_simulate", *arguments, "--output", folder)
        marker.write_text(wanted)
        return folder

    def walk_run(self, scenario, seed, people, duration=None, loops=True):
        """(sequence, output folder, summary) of a run over a simulated sequence; `people` are
        "recorded" or found by the "network"; without `loops` nothing is ever found again."""
        sequence = self.simulated(scenario, seed, duration)
        detector = self.network_arguments() if people == "network" else ("--detector", people)
        name = f"{sequence.name}_{people}_run" if loops else f"{sequence.name}_{people}_open_run"
        status = self.output / name / "status.csv"  # beside the folder of the run
        settings = () if loops else ("--set", "loop.enabled=false")
        return sequence, *self.run(name, sequence, *detector, *settings, "--save-status", status)

    def ate_row(self, what, summary, bar=None, digits=4):
        """The error of a run's trajectory as loops have corrected it in the end, which `bar` is for, and beside it that
        of the live poses. No figure without truth."""
        self.row(what, summary.get("ate_rmse_m"), "m", bar, digits=digits,
                 live=summary.get("live", {}).get("ate_rmse_m"))

    def wrong_rows(self, name, summary, bar=0):
        """Jumps and slides (a bad motion over a second), and poses off from the truth (aligned at the start), each in
        the end and at the time."""
        live = summary.get("live", {})
        self.row(f"{name}, wrong poses", summary["wrong_poses"], "", bar, digits=0,
                 live=live.get("wrong_poses"))
        self.row(f"{name}, false poses", summary["false_poses"], "", digits=0,
                 live=live.get("false_poses"))

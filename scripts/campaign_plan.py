# SPDX-License-Identifier: BSD-3-Clause
"""The recordings and settings of a campaign: read from its file, checked, and written for its jobs."""
import contextlib
import dataclasses
import fcntl
import json
import pathlib
import re
import shlex

import yaml

from bench_runs import fingerprint
from report_runs import build_of, kept

NAME = re.compile(r"[\w.-]+$")


class Wrong(Exception):
    """An error in the campaign's file: what it has and what was expected."""


@dataclasses.dataclass
class Recording:
    name: str
    path: str  # of a folder or bag; empty: simulated
    arguments: list  # of posefusion_run; of posefusion_simulate where it is simulated


def words(value, where):
    """A text as on a command line, or a list of words."""
    if value is None:
        return []
    if isinstance(value, str):
        return shlex.split(value)
    if isinstance(value, list) and not any(isinstance(word, (dict, list)) for word in value):
        return [str(word) for word in value]
    raise Wrong(f"{where} is {value!r}, expected arguments as on a command line")


def checked(entry, known, where):
    unknown = sorted(set(entry) - set(known))
    if unknown:
        raise Wrong(f"{where}: {unknown[0]} is unknown, expected some of {', '.join(known)}")
    return entry


def recordings_of(entry, folder, where):
    if isinstance(entry, str):
        entry = {"path": entry}
    if not isinstance(entry, dict) or ("path" in entry) == ("scenario" in entry):
        raise Wrong(f"{where} is {entry!r}, expected a path, or a path or a scenario with further keys")
    arguments = words(entry.get("arguments"), f"{where}: arguments")
    if "path" in entry:
        checked(entry, ("path", "name", "arguments"), where)
        path = (folder / pathlib.Path(entry["path"]).expanduser()).resolve()
        if not path.exists():
            raise Wrong(f"{where}: {path} does not exist")
        return [Recording(str(entry.get("name", path.stem)), str(path), arguments)]
    checked(entry, ("scenario", "name", "arguments", "seeds", "duration_s"), where)
    seeds = entry.get("seeds", [1])
    if not isinstance(seeds, list) or not all(isinstance(seed, int) for seed in seeds):
        raise Wrong(f"{where}: seeds are {seeds!r}, expected a list of numbers")
    scenario = str(entry["scenario"])
    if "duration_s" in entry:
        arguments = ["--duration", str(entry["duration_s"]), *arguments]
    return [Recording(f"{entry.get('name', scenario)}_{seed}", "", [scenario, "--seed", str(seed), *arguments])
            for seed in seeds]


def read(file):
    """{"recordings": [Recording], "settings": {name: arguments}} of a campaign's file."""
    try:
        content = yaml.safe_load(file.read_text())
    except yaml.YAMLError as error:
        raise Wrong(f"{file}: {' '.join(str(error).split())}") from error
    if not isinstance(content, dict):
        raise Wrong(f"{file}: expected recordings and settings")
    checked(content, ("recordings", "settings"), str(file))
    listed, settings = content.get("recordings") or [], content.get("settings") or {"default": ""}
    if not isinstance(listed, list) or not listed or not isinstance(settings, dict):
        raise Wrong(f"{file}: expected a list of recordings, and settings by name")
    recordings = [recording for i, entry in enumerate(listed)
                  for recording in recordings_of(entry, file.resolve().parent, f"{file}: recording {i + 1}")]
    names = [recording.name for recording in recordings]
    for name in [*names, *map(str, settings)]:
        if not NAME.match(name) or names.count(name) > 1:
            raise Wrong(f"{file}: the name '{name}': expected letters, digits, . - _, and each name once")
    return {"recordings": recordings, "settings": {str(name): words(value, f"{file}: settings: {name}")
                                                   for name, value in settings.items()}}


class Plan:
    def __init__(self, campaign, output):
        self.output, self.recordings, self.settings = output, campaign["recordings"], campaign["settings"]
        self.file = output / "plan.json"
        self.build = build_of()

    @contextlib.contextmanager
    def lock(self):
        with open(self.output / "lock", "w", encoding="ascii") as handle:
            try:
                fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except OSError as error:
                raise Wrong(f"{self.output}: another campaign is at work in it") from error
            yield

    def source(self, recording):
        """Identifies the sources of a recording, so that a changed one is run again."""
        if not recording.path:
            return fingerprint(recording.arguments[0], recording.arguments)
        path = pathlib.Path(recording.path)
        listed = sorted(path.rglob("*")) if path.is_dir() else [path]
        newest = max((item.stat().st_mtime_ns for item in listed if item.is_file()), default=0)
        return f"{path} {newest}"

    def as_json(self):
        runs = {}
        for recording in self.recordings:
            source = self.source(recording)
            of_run = recording.arguments if recording.path else []
            for setting, arguments in self.settings.items():
                every = [*of_run, *arguments]
                runs[f"{recording.name}/{setting}"] = {
                    "arguments": every, "key": {"build": self.build, "source": source, "arguments": every}}
        return {"recordings": {r.name: {"path": r.path, "arguments": r.arguments, "source": self.source(r)}
                               for r in self.recordings},
                "settings": list(self.settings), "runs": runs, "build": self.build,
                "facts": {name: " ".join(arguments) or "as they are" for name, arguments in self.settings.items()}}

    def write(self):
        temporary = self.file.with_name(self.file.name + ".part")
        temporary.write_text(json.dumps(self.as_json(), indent=1))
        temporary.replace(self.file)

    def figures(self):
        """(name, key, file) of each run."""
        for name, run in json.loads(self.file.read_text())["runs"].items():
            yield name, run["key"], self.output / "figures" / f"{name}.json"

    def count(self):
        return len(self.recordings) * len(self.settings)

    def sweep(self):
        """Removes results of other sources and figures of failed runs; returns how many runs are missing."""
        (self.output / "index.html").unlink(missing_ok=True)  # the tables may be of another file
        for recording in self.recordings:
            made_from = self.output / "recordings" / recording.name / "made_from"
            if made_from.is_file() and made_from.read_text() != self.source(recording):
                made_from.unlink()
        missing = 0
        for _, key, file in self.figures():
            figures = kept(file, key)
            if figures is None or "failed" in figures:
                file.unlink(missing_ok=True)
                missing += 1
        return missing

    def failures(self):
        found = [(name, kept(file, key)) for name, key, file in self.figures()]
        return [(name, (figures or {"failed": "was not run"})["failed"]) for name, figures in found
                if figures is None or "failed" in figures]

# SPDX-License-Identifier: BSD-3-Clause
"""The sequences of a report: folders, bags, or scenarios of the simulator."""
import dataclasses
import hashlib
import pathlib
import re

from bench_runs import ROOT, Runs

# The paper's four recordings and two more of TUM's fr3, as the simulator has them.
DEFAULT = ("walking_static", "walking_xyz", "walking_halfsphere", "walking_rpy", "hrpslam1", "hrpslam2")
LONG_ARGUMENTS = ("--set", "fps=15")  # as scripts/bench --long makes the two of a quarter of an hour
LONG = ("hrpslam1", "hrpslam2")
# Scenarios in which it decides whether people are removed, and the word that stands for all of them.
HARD_PEOPLE = ("people_cover", "people_along", "people_approach", "people_bare_wall", "people_wait")
GROUPS = {"hard_people": HARD_PEOPLE}


def expanded(words):
    """Names of groups replaced by what they stand for."""
    return [name for word in words for name in GROUPS.get(word, (word,))]


@dataclasses.dataclass
class Sequence:
    name: str  # as the literature calls it: walking_xyz
    path: pathlib.Path
    simulated: bool

    @property
    def heading(self):
        return self.name + (" (simulated)" if self.simulated else "")

    @property
    def key(self):
        """Name of its folder of runs."""
        return self.name + ("_simulated" if self.simulated else "")

    @property
    def has_truth(self):
        return (self.path / "groundtruth.txt").is_file()

    def fingerprint(self):
        """Changes when the recording does; images count by their names and sizes alone."""
        digest = hashlib.sha256()
        if self.path.is_file():
            return f"{self.path.name} {self.path.stat().st_size}"
        for path in sorted(self.path.iterdir()):
            if path.is_file():
                digest.update(path.name.encode() + path.read_bytes())
            elif path.name in ("rgb", "depth"):
                digest.update("".join(f"{p.name} {p.stat().st_size} " for p in sorted(path.iterdir())).encode())
        return digest.hexdigest()[:16]


def literature_name(name, simulated):
    """walking_xyz of rgbd_dataset_freiburg3_walking_xyz, of fr3_walking_xyz, of walking_xyz_1 (simulated)."""
    name = name[:-4] if name.endswith(".bag") else name
    if simulated:
        return re.sub(r"_\d+(_.*)?$", "", name)
    name = re.sub(r"^rgbd_bonn_", "", name)
    found = re.match(r"(?:rgbd_dataset_)?(?:freiburg|fr)([123])_(.*)$", name)
    if not found:
        return name
    camera, rest = found.groups()
    if rest.startswith(("walking_", "sitting_")):
        return rest
    return f"fr{camera}_{'office' if rest == 'long_office_household' else rest}"


def at_path(path):
    path = pathlib.Path(path).resolve()
    simulated = (path / "events.json").is_file()
    return Sequence(literature_name(path.name, simulated), path, simulated)


class Finder:
    """Turns the words of a command line into sequences; renders what is not there."""

    def __init__(self, output, ready, seed, duration):
        class Options:
            pass

        Options.output, Options.sequences, Options.duration = output / "sequences", ready, duration
        self.runs, self.seed = Runs(Options), seed

    def find(self, word):
        """Throws Failed where it cannot be rendered, OSError where there is nothing of that name."""
        if pathlib.Path(word).exists():
            return at_path(word)
        if not (ROOT / "config" / "scenarios" / f"{word}.yaml").is_file():
            raise OSError(f"{word}: is no folder, bag or scenario of the simulator")
        more = LONG_ARGUMENTS if word in LONG else ()
        return Sequence(word, self.runs.simulated(word, self.seed, None, *more), True)

# SPDX-License-Identifier: BSD-3-Clause
"""Two maps merged into one: of two recordings of one room, and of rooms that have nothing in common."""
import pathlib
import shutil

from bench_report import Failed, call
from bench_runs import PROGRAMS, Runs, note

# The walk once round the room, cut in two that have a fifth of it in common. Where it ends it is
# again where it began.
PARTS = ((0.0, 0.62), (0.49, 1.0))
LISTS = ("associations.txt", "rgb.txt", "depth.txt")
OFFICE, OFFICE_SECONDS = "walking_halfsphere", 30


def part_of(sequence, folder, begin, end):
    """A TUM folder with the frames of a sequence from one share of it to another; all but the lists
    of frames is the sequence's own."""
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    for path in pathlib.Path(sequence).iterdir():
        if path.name not in LISTS:
            (folder / path.name).symlink_to(path.resolve())
            continue
        frames = [line for line in path.read_text().splitlines(keepends=True) if not line.startswith("#")]
        first, last = int(begin * len(frames)), int(end * len(frames))
        (folder / path.name).write_text("".join(frames[first:last]))
    return folder


class Merge(Runs):
    def merge(self):
        """Two recordings of a room become one map; of another room is nothing in it."""
        for seed in self.options.seeds:
            sequence = self.simulated("loop_room", seed)
            maps, errors_m = [], []
            for i, (begin, end) in enumerate(PARTS):
                name = f"{sequence.name}_part_{i + 1}"
                part = part_of(sequence, self.output / name, begin, end)
                folder, summary = self.run(f"{name}_run", part, "--detector", "recorded")
                maps.append(folder / "map.pfdb")
                errors_m.append(summary["ate_rmse_m"])
            self.merged_rows(f"loop_room {seed} in two recordings", sequence, maps, errors_m)
            self.other_room(seed, maps[0])

    def merged_rows(self, name, sequence, maps, errors_m):
        both, said = self.merge_files(*maps)
        out = self.output / both.stem
        shutil.rmtree(out, ignore_errors=True)
        call(PROGRAMS / "posefusion_map", "check", both)
        call(PROGRAMS / "posefusion_map", "export", both, "--output", out)
        merged_m = self.evaluate(sequence, out / "trajectory.txt")["ate_m"]["rmse"]
        self.fact(f"{name}: merged", None, said.split("merged: ")[-1].strip())
        for i, error_m in enumerate(errors_m):
            self.row(f"{name}: ATE RMSE of recording {i + 1}", error_m, "m")
        self.row(f"{name}: ATE RMSE of the merged map", merged_m, "m")
        self.row(f"{name}: that against the worse of the two", merged_m / max(errors_m), "x", 1.3, digits=2)
        surface = self.evaluate("surface", out, sequence)
        self.row(f"{name}: surfels in two layers of one surface", 100 * surface["two_layers"], "%", digits=2)

    def merge_files(self, first, second):
        """(the new map, the output of the program)."""
        note(f"merging {first.parent.parent.name} and {second.parent.parent.name}")
        both = self.output / f"{first.parent.parent.name}_merged.pfdb"
        both.unlink(missing_ok=True)
        return both, call(PROGRAMS / "posefusion_map", "merge", first, second, "--output", both)

    def other_room(self, seed, room):
        """A map of an office does not become one with that of the laboratory."""
        _, folder, _ = self.walk_run(OFFICE, seed, "recorded", OFFICE_SECONDS)
        try:
            said, refused = self.merge_files(room, folder / "map.pfdb")[1], False
        except Failed as error:
            said, refused = str(error), "does not become one" in str(error)
        self.fact(f"loop_room {seed} and {OFFICE} {seed}: refused", refused, said.split(": ")[-1].strip())

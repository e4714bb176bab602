# SPDX-License-Identifier: BSD-3-Clause
"""The part `mesh` of scripts/bench: meshes of maps against the true surface of the room, by our method and
by those of PCL, and grids against its plan."""
import json
import re

from bench_report import call
from bench_runs import PROGRAMS, Runs, note

OTHERS = {"poisson": "PCL's Poisson", "greedy": "PCL's greedy projection"}


class Mesh(Runs):
    def mesh(self):
        for seed in self.options.seeds:
            sequence, folder, _ = self.walk_run("loop_room", seed, "embedded")
            name = f"loop_room {seed}"
            surfels = self.evaluate("surface", folder, sequence)
            self.row(f"{name}, surfels to the true surface, median", 1e3 * surfels["median_m"], "mm", digits=1)
            self.row(f"{name}, the same, 95 %", 1e3 * surfels["p95_m"], "mm", digits=1)
            ours = self.mesh_rows(f"{name}, mesh", sequence, folder, "nets", surfels)
            others = {method: self.mesh_rows(f"{name}, {what}", sequence, folder, method)
                      for method, what in OTHERS.items()}
            self.row(f"{name}, mesh against PCL's Poisson, time", ours[0] / others["poisson"][0], "x", 0.5, digits=2)
            self.row(f"{name}, mesh against PCL's Poisson, median", ours[1] / others["poisson"][1], "x", 1.0,
                     digits=2)
            self.grid_rows(name, sequence, folder)
        self.big_mesh_rows(folder)

    def grid_rows(self, name, sequence, folder):
        """The plan for a robot's navigation against the true one."""
        file = self.output / f"{sequence.name}_grid.yaml"
        call(PROGRAMS / "posefusion_map", "grid", folder / "map.pfdb", "-o", file)
        found = self.evaluate("grid", file, folder, sequence)
        self.row(f"{name}, cells of 5 cm that are right, of {found['seen']} seen", 100 * found["share"], "%", 97,
                 most=False, digits=2)
        self.row(f"{name}, of {found['false_free'] + found['false_occupied']} wrong ones right one cell beside",
                 found["near"], "", digits=0)

    def mesh_rows(self, name, sequence, folder, method, surfels=None):
        """(seconds, median in metres). Bars are for our own method, where `surfels` are given."""
        def bar(value):
            return value if surfels else None
        note(f"making {name}")
        file = self.output / f"{sequence.name}_{method}.ply"
        said = call(PROGRAMS / "posefusion_map", "mesh", folder / "map.pfdb", "-o", file, "--method", method)
        seconds = float(re.search(r" in ([\d.]+) s", said).group(1))
        found = self.evaluate("mesh", file, folder, sequence)
        self.row(f"{name}, {found['triangles']} triangles, time", seconds, "s", bar(10), digits=2)
        self.row(f"{name}, to the true surface, median", 1e3 * found["median_m"], "mm",
                 bar(1e3 * surfels["median_m"] + 2 if surfels else None), digits=1)
        self.row(f"{name}, the same, 95 %", 1e3 * found["p95_m"], "mm",
                 bar(1e3 * surfels["p95_m"] + 10 if surfels else None), digits=1)
        self.row(f"{name}, triangles farther than 5 cm from a surfel", found["invented"], "", bar(0), digits=0)
        self.row(f"{name}, covers of the surface seen by three views", 100 * found["coverage"], "%", bar(98),
                 most=False, digits=2)
        return seconds, found["median_m"]

    def big_mesh_rows(self, folder):
        """Copies of the last room beside each other."""
        note("making a mesh of 4 million surfels")
        found = json.loads(call(PROGRAMS / "posefusion_big_mesh", folder / "map.ply"))
        name = f"mesh of {found['surfels']} surfels, {found['triangles']} triangles"
        self.row(f"{name}, time", found["time_s"], "s", 60, digits=1)
        self.row(f"{name}, peak memory", found["peak_memory_mb"], "MB", 1500, digits=0)
        self.fact(f"{name}, one thread", found["one_thread_same"], f"{found['one_thread_s']:.1f} s, the same bytes"
                  if found["one_thread_same"] else "other bytes")

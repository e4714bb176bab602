# SPDX-License-Identifier: BSD-3-Clause
"""The part `viewer` of scripts/bench: rviz's display of a million surfels, drawn by software on a
display of its own."""
import re
import shutil

from bench_report import Failed
from bench_ros import Session
from bench_runs import PROGRAMS, Runs, note

SURFELS = 1000000
TIME_LIMIT_S = 300


class Viewer(Runs):
    def viewer(self):
        if not shutil.which("xvfb-run"):
            raise Failed("xvfb-run is needed")
        with Session(self.output / "viewer_session") as session:
            session.environment["LIBGL_ALWAYS_SOFTWARE"] = "1"
            for keep_fluid, bar in ((0, None), (1, 8)):
                self.viewer_rows(session, keep_fluid, bar)

    def viewer_rows(self, session, keep_fluid, bar):
        name = f"{'fluid' if keep_fluid else 'all'}"
        note(f"drawing a million surfels, {name}")
        said = session.run(name, "xvfb-run", "-a", "-s", "-screen 0 1400x900x24", PROGRAMS / "posefusion_viewer_speed",
                           "--surfels", SURFELS, "--keep-fluid", keep_fluid, "--picture", self.output / f"viewer_{name}.png",
                           timeout=TIME_LIMIT_S)
        found = re.search(r"([0-9.]+) frames/s, (\d+) ms of processor time each; (\d+) of", said)
        if not found:
            raise Failed(f"no figures: {said[-500:]}")
        what = f"rviz, software rendering, {SURFELS} surfels, {'kept fluid' if keep_fluid else 'all drawn'}"
        self.row(f"{what}: discs", int(found[3]), "", digits=0)
        self.row(f"{what}: processor time of a frame", int(found[2]), "ms", digits=0)
        self.row(f"{what}: frames a second", float(found[1]), "", bar, most=False, digits=1)

# SPDX-License-Identifier: BSD-3-Clause
"""The part `rates` of scripts/bench: the same walk in pictures of other sizes and at other rates, against
640x480 at 30 Hz."""
import shutil

from bench_runs import Runs, note

SECONDS = 20
USUAL_HZ, DRAWN_HZ = 30, 60
RATES_HZ = (10, 15, 60)
# The same depth camera whatever the size: it matches, and is as inexact beside the view, at 640 across.
# 640x360 sees what 1280x720 sees, which is less than 640x480 does.
SIZES = ((320, 240), (640, 360), (1280, 720))
EXPOSURE = ("--set", "color.max_exposure_ms=16")  # what is possible at 60 Hz, at all rates
MOST = 1.3  # times the error at the usual size and rate
LISTS = ("associations.txt", "rgb.txt", "depth.txt")


def thinned(source, folder, every):
    """A recording of every n-th frame of another one, at links to its files."""
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir()
    for path in source.resolve().iterdir():
        if path.name not in LISTS:
            (folder / path.name).symlink_to(path)
            continue
        lines = path.read_text().splitlines()
        rows = [line for line in lines if not line.startswith("#")]
        (folder / path.name).write_text("\n".join(rows[every - 1::every]) + "\n")
    return folder


class Rates(Runs):
    def rates(self):
        for seed in self.options.seeds:
            camera = ("--set", f"depth.specimen={seed}", *EXPOSURE)
            drawn = self.simulated("loop_room", seed, SECONDS, *camera, "--set", f"fps={DRAWN_HZ}",
                                   name=f"rates_{seed}_640_{DRAWN_HZ}hz")
            usual = self.rates_run(f"{seed}, 640x480, {USUAL_HZ} Hz", self.at_rate(drawn, USUAL_HZ))
            for rate in RATES_HZ:
                self.rates_run(f"{seed}, 640x480, {rate} Hz", self.at_rate(drawn, rate), usual)
            for width, height in SIZES:
                size = ("--set", f"camera.width={width}", "--set", f"camera.height={height}",
                        "--set", f"depth.disparity_steps={8 * 640 / width:g}",
                        "--set", f"depth.lateral={width / 640:g}")
                sequence = self.simulated("loop_room", seed, SECONDS, *camera, *size,
                                          name=f"rates_{seed}_{width}_{USUAL_HZ}hz")
                self.rates_run(f"{seed}, {width}x{height}, {USUAL_HZ} Hz", sequence, usual)

    def at_rate(self, drawn, rate):
        if rate == DRAWN_HZ:
            return drawn
        note(f"thinning {drawn.name} to {rate} Hz")
        return thinned(drawn, self.output / f"{drawn.name}_at_{rate}hz", DRAWN_HZ // rate)

    def rates_run(self, name, sequence, usual=None):
        """Prints the errors of a run; against those of `usual`, where it is given. Returns them."""
        _, summary = self.run(f"{sequence.name}_run", sequence, "--detector", "recorded")
        live = summary["live"]
        states = summary["frames"]["by_state"]
        found = {"ATE, final": summary["ate_rmse_m"], "ATE, live": live["ate_rmse_m"]}
        for what, value in found.items():
            self.row(f"loop_room {name}: {what}", value, "m", usual and round(MOST * usual[what], 4))
        found["lost"] = 100 * states.get("lost", 0) / max(1, sum(states.values()))
        self.row(f"loop_room {name}: frames lost", found["lost"], "%", usual and usual["lost"], digits=1)
        self.row(f"loop_room {name}: false poses, live", live["false_poses"], "", digits=0)
        return found

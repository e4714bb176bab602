# SPDX-License-Identifier: BSD-3-Clause
"""The part `calibration` of scripts/bench: a walk by one camera as it is, and again with the calibration that its own
map gives; each seed has a camera of its own."""
from bench_report import Failed, call
from bench_runs import PROGRAMS, Runs, note


# What cameras may have besides the usual smooth field, or in its place: arguments of the simulator, and the most
# that the error with calibration may be of that without.
CAMERAS = {"no distortion": (("depth.distortion=0",), 1.03),
           "stripes": (("depth.stripe_mm=6",), 1.05),
           "bowl": (("depth.bowl_mm=20",), 1.05),
           "drift": (("depth.drift_mm=8", "depth.drift_percent=50"), 1.05),
           "time of flight": (("depth.kind=time_of_flight",), 1.05),
           "active stereo": (("depth.kind=active_stereo",), 1.05)}


class Calibration(Runs):
    def calibration(self):
        for seed in self.options.seeds:
            sequence = self.simulated("loop_room", seed, None, "--set", f"depth.specimen={seed}")
            camera = f"loop_room {seed}, camera {seed}"
            run = self.run(f"{sequence.name}_as_measured", sequence, "--detector", "embedded",
                           "--set", "calibration.mode=none")[0]
            self.camera_rows(f"{camera}, depth as measured", sequence, run, {})
            run, summary = self.run(f"{sequence.name}_learned", sequence, "--detector", "embedded")
            self.row(f"{camera}, learned in one pass from scratch: peak memory", summary["peak_memory_mb"], "MB", 400,
                     digits=0)
            self.camera_rows(f"{camera}, learned in one pass from scratch", sequence, run,
                             {"ate": 0.030, "live": 0.060, "median": 12, "p95": 35, "layers": 0.3})
            file = self.output / f"{sequence.name}_calibration.yaml"
            self.calibrate(camera, sequence, run, file)
            run = self.run(f"{sequence.name}_calibrated", sequence, "--detector", "embedded", "--calibration", file)[0]
            self.camera_rows(f"{camera}, with the calibration of its first pass", sequence, run,
                             {"ate": 0.022, "live": 0.030, "false": 0, "median": 12, "p95": 35, "layers": 0.3})

    def cameras(self):
        """Cameras unlike the one that the estimator was made for: it must not make them worse."""
        seed = self.options.seeds[0]
        for camera, (settings, bar) in CAMERAS.items():
            arguments = [word for setting in settings for word in ("--set", setting)]
            sequence = self.simulated("loop_room", seed, None, "--set", f"depth.specimen={seed}", *arguments,
                                      name=f"loop_room_{seed}_{camera.replace(' ', '_')}")
            errors = [self.run(f"{sequence.name}_{mode}", sequence, "--detector", "recorded", "--set",
                               f"calibration.mode={mode}")[1] for mode in ("none", "learn")]
            (final, live), (learned, learned_live) = ((e["ate_rmse_m"], e["live"]["ate_rmse_m"]) for e in errors)
            name = f"loop_room {seed}, {camera}"
            self.row(f"{name}: ATE as measured", final, "m", digits=4, live=live)
            self.row(f"{name}: ATE while it learns", learned, "m", digits=4, live=learned_live)
            self.row(f"{name}: the second by the first", learned / final, "x", bar, digits=2, live=learned_live / live)

    def calibrate(self, name, sequence, run, file):
        note(f"calibrating {sequence.name}")
        said = call(PROGRAMS / "posefusion_calibrate", run / "map.pfdb", "--output", file, "--truth", sequence)
        truth = next((line for line in said.splitlines() if "correlation" in line), None)
        if truth is None:
            raise Failed(f"posefusion_calibrate printed no comparison with the truth: {said}")
        words = truth.replace(";", "").split()
        self.row(f"{name}: field against the truth, correlation", float(words[1]), "", 0.93, most=False, digits=3)
        self.row(f"{name}: what is left at 4 m, RMS", float(words[words.index("4") - 3]), "mm", 10, digits=1)

    def camera_rows(self, name, sequence, run, bars):
        """Final and live errors of the trajectory, and those of the surface; `bars` by name, where there are any."""
        final = self.evaluate(sequence, run)
        live = final["live"]
        self.row(f"{name}: ATE, final", final["ate_m"]["rmse"], "m", bars.get("ate"), digits=4)
        self.row(f"{name}: ATE, live", live["ate_m"]["rmse"], "m", bars.get("live"), digits=4)
        self.row(f"{name}: live poses off by more than 0.10 m or 5 degrees", live["false_poses"], "",
                 bars.get("false"), digits=0)
        surface = self.evaluate("surface", run, sequence)
        self.row(f"{name}: surfels to the true surface, median", 1e3 * surface["median_m"], "mm",
                 bars.get("median"), digits=1)
        self.row(f"{name}: the same, 95 %", 1e3 * surface["p95_m"], "mm", bars.get("p95"), digits=1)
        self.row(f"{name}: surfels in two layers", 100 * surface["two_layers"], "%", bars.get("layers"), digits=2)

# SPDX-License-Identifier: BSD-3-Clause
"""Times and the yardstick that they are compared with, the blur gate, and repeatability."""
import filecmp
import json
import os
import re
import shutil
import statistics

from bench_report import call
from bench_runs import PROGRAMS, ROOT, Runs, newest, note

# Builds are compared at the same work: the default of older ones is the network in every 5th frame.
LOOKS_AS_BEFORE = "--set", "pose.every_nth_frame=5"


class Speed(Runs):
    def speed(self):
        data = self.options.data / "kitchen_people"
        found = [self.run(f"speed_{i}", data, *self.network_arguments())[1]
                 for i in range(self.options.repeats)]
        stages = {name for summary in found for name in summary["stages"]}
        for stage in sorted(stages):
            times = [s["stages"][stage]["median_ms"] for s in found if stage in s["stages"]]
            bar = 25 if stage == "tracking_and_fusion" else None
            self.row(f"kitchen_people, {stage}, median", statistics.median(times), "ms", bar, digits=1)
        self.row("kitchen_people, whole chain", statistics.median(s["frames_per_second"] for s in found),
                 "frames/s", 20, most=False, digits=1)
        self.row("kitchen_people, peak memory", max(s["peak_memory_mb"] for s in found), "MB", digits=0)

    def yardstick(self):
        """Machines differ by a factor of two from day to day: a speed is given as a ratio to that of OpenCV's odometry,
        on the same frames, in turns."""
        data = self.options.data / "kitchen_people"
        theirs, ratios, gains = [], {"tracking_and_fusion": [], "segmentation": [], "frames": []}, []
        for i in range(self.options.repeats):
            note("running RgbdICPOdometry")
            theirs.append(json.loads(call(PROGRAMS / "posefusion_baseline", data)))
            ours = self.run(f"yardstick_{i}", data, "--detector", "embedded")[1]
            for stage in ("tracking_and_fusion", "segmentation"):
                ratios[stage].append(ours["stages"][stage]["median_ms"] / theirs[-1]["median_ms"])
            ratios["frames"].append(ours["frames_per_second"] / theirs[-1]["frames_per_s"])
            if self.options.baseline:
                older = self.baseline_speed(data)
                ours = self.run(f"gain_{i}", data, *self.network_arguments(), *LOOKS_AS_BEFORE)[1]
                gains.append(ours["frames_per_second"] / older)
        self.row("kitchen_people, RgbdICPOdometry, median",
                 statistics.median(t["median_ms"] for t in theirs), "ms", digits=1)
        self.row("kitchen_people, RgbdICPOdometry, ATE RMSE", theirs[0]["ate_rmse_m"], "m")
        of = "kitchen_people, embedded, against RgbdICPOdometry"
        self.row(f"{of}: tracking and fusion", statistics.median(ratios["tracking_and_fusion"]), "x", 0.45, digits=3)
        self.row(f"{of}: segmentation", statistics.median(ratios["segmentation"]), "x", 0.10, digits=3)
        self.row(f"{of}: frames a second", statistics.median(ratios["frames"]), "x", 1.3, most=False, digits=2)
        if gains:
            self.row("kitchen_people, network in every 5th frame, whole chain against the older build",
                     statistics.median(gains), "x", 1.25, most=False, digits=2)

    def baseline_speed(self, data):
        """Frames per second of the posefusion_run of an older build (--baseline)."""
        note("running the older build")
        folder = self.output / "baseline"
        shutil.rmtree(folder, ignore_errors=True)
        call(self.options.baseline / "posefusion_run", data, "--output", folder,
             *self.network_arguments(), *LOOKS_AS_BEFORE)
        return json.loads((newest(folder) / "summary.json").read_text())["frames_per_second"]

    def big_map(self):
        """The same views among few and among many surfels: copies of the map they give, out of view."""
        note("mapping kitchen_static among its own and 4 million surfels")
        found = json.loads(call(PROGRAMS / "posefusion_big_map", self.options.data / "kitchen_static",
                                "--repeats", str(self.options.repeats)))
        for size in ("few", "many"):
            self.row(f"kitchen_static, {found[size]['surfels']} surfels, tracking and fusion, median",
                     found[size]["median_ms"], "ms", digits=1)
        self.row("kitchen_static, 4 M surfels against the view's own, tracking and fusion", found["ratio"], "x",
                 1.15, digits=2)

    def big_correction(self):
        """All of a building of copies of one room is corrected: the work that this leaves to the tracking thread."""
        note("correcting a map of 10 million surfels and 5,000 keyframes")
        found = json.loads(call(PROGRAMS / "posefusion_big_correction",
                                self.options.data / "kitchen_static"))
        what = f"{found['surfels']} surfels, {found['keyframes']} keyframes, a correction of all"
        times = found["on_the_tracking_thread_ms"]
        self.row(f"{what}, on the tracking thread, median", times["median"], "ms", digits=2)
        self.row("the same, most", times["most"], "ms", 2, digits=2)
        self.row("the same, until it is taken in, most", found["until_taken_in_s"]["most"], "s", 3,
                 digits=2)

    def gate(self):
        found = json.loads(call(PROGRAMS / "posefusion_gate_check", self.options.data / "kitchen_static"))
        for key, what in (("contrast_halved_s", "contrast halved"), ("dull_wall_s", "a dull wall")):
            self.row(f"kitchen_static, blur gate, {what}: back to normal after", found[key], "s", 1,
                     digits=2)

    def simulator(self):
        for what, blur, bar in (("without", "false", 10), ("with", "true", 4)):
            found = []
            for _ in range(self.options.repeats):
                note(f"simulating walking_static {what} motion blur")
                folder = self.output / "simulated"
                shutil.rmtree(folder, ignore_errors=True)
                said = call("bash", "-c", '"$@" 2>&1', "bash", PROGRAMS / "posefusion_simulate",
                            "walking_static", "--duration", "3", "--output", folder,
                            "--set", f"color.motion_blur={blur}")
                found.append(float(re.findall(r"([0-9.]+) frames per second", said)[-1]))
            self.row(f"simulator, room with two people, {what} motion blur",
                     statistics.median(found), "frames/s", bar, most=False, digits=1)
        folder = self.output / "empty_room_input"
        shutil.rmtree(folder, ignore_errors=True)
        call(PROGRAMS / "posefusion_simulate", "empty_room", "--duration", "5", "--output", folder)
        _, summary = self.run("empty_room", folder, "--detector", "none")
        self.ate_row("empty_room (simulated), 150 frames, ATE RMSE", summary)
        _, real = self.run("static_150", self.options.data / "kitchen_static", "--detector", "none",
                           "--max-frames", "150")
        self.row("empty_room against 150 frames of kitchen_static, ATE",
                 summary["ate_rmse_m"] / real["ate_rmse_m"], "x", 10, digits=2)

    def same(self, what, first, second, *names):
        equal = all(filecmp.cmp(first / name, second / name, shallow=False) for name in names)
        self.fact(what, equal, "identical" if equal else "different")

    def repeatability(self):
        one, _ = self.network("one_thread", "kitchen_people", "--threads", "1")
        two, _ = self.network("two_threads", "kitchen_people", "--threads", "2")
        self.same("kitchen_people, 1 and 2 threads, trajectory and map", one, two,
                  "trajectory.txt", "map.ply")

    def nodelets(self):
        bag = self.output / "kitchen_people.bag"
        call(PROGRAMS / "posefusion_to_bag", self.options.data / "kitchen_people", bag)
        offline, _ = self.run("bag_offline", bag, *self.network_arguments())
        out = self.output / "bag_nodelets"
        shutil.rmtree(out, ignore_errors=True)
        note("replaying the bag through the nodelets")
        launch = (f"source '{ROOT}/devel/setup.bash' && roslaunch --port 11399 posefusion replay.launch "
                  f"bag:='{bag}' output:='{out}' detector:=network model:='{self.options.model}'")
        call("bash", "-c", launch, timeout=1200,
             env={**os.environ, "ROS_MASTER_URI": "http://localhost:11399", "ROS_HOSTNAME": "localhost"})
        bag.unlink()
        self.same("kitchen_people as a bag, nodelets and offline runner, trajectory", offline, out / "latest",
                  "trajectory.txt")

# SPDX-License-Identifier: BSD-3-Clause
"""People detected by the package's own model, alone and beside the network: masks, map, time."""
import json
import shutil
import statistics

from bench_report import call
from bench_runs import PROGRAMS, newest, note
from bench_recordings import Recordings

# Simulated people outside the model's training, whose rooms are made differently.
MOVING = ("walking_static", "walking_xyz", "walking_halfsphere", "walking_rpy", "sitting_static",
          "sitting_xyz", "sitting_halfsphere")
SECONDS = 10
EMBEDDED = "--detector", "embedded"


class People(Recordings):
    def both(self):
        return "--detector", "network+embedded", "--model", self.options.model

    def people(self):
        self.people_of_kitchen("embedded", EMBEDDED, iou=0.55, precision=0.90)
        if self.options.model.exists():
            self.people_of_kitchen("network+embedded", self.both(), iou=0.75, precision=0.93)
            self.people_of_kitchen("network", self.network_arguments(), iou=0.74, precision=0.95)
            self.people_speed()
        self.empty_scenes()
        self.simulated_people()
        self.people_in_map()

    def near(self):
        """Three people as near as 0.6 m, cut by the border: semi-synthetic."""
        data = self.options.data / "kitchen_near"
        folder, summary = self.run("kitchen_near", data, *EMBEDDED, "--save-masks")
        self.row("kitchen_near, embedded, mean IoU",
                 self.evaluate("masks", data, folder)["frames_over_2_percent"]["mean_iou"], "", 0.88, most=False,
                 digits=3)
        self.among_people("kitchen_near, embedded", folder, summary, data, ate=0.022, posed=98, on_people=0.5)

    def crowd(self):
        """Ten people, who nearly cover the view."""
        for seed in self.options.seeds:
            data = self.simulated("crowd", seed)
            folder, summary = self.run(f"crowd_{seed}_embedded", data, *EMBEDDED)
            self.among_people(f"crowd {seed}, embedded", folder, summary, data, ate=None, posed=90, on_people=1.5)

    def among_people(self, name, folder, summary, data, ate, posed, on_people):
        self.ate_row(f"{name}, ATE RMSE", summary, ate)
        self.wrong_rows(name, summary)
        found = self.evaluate("run", folder, data)
        seen = found["beside_people"]
        self.row(f"{name}, of {seen['frames']} frames of which people leave a quarter, with a pose at the time",
                 100 * seen["with_a_pose"] / seen["frames"] if seen["frames"] else None, "%", posed, most=False, digits=1)
        self.row(f"{name}, stable surfels on people", 100 * found["people_in_map"]["part"], "%", on_people, digits=2)

    def people_of_kitchen(self, detector, arguments, iou, precision):
        name = f"kitchen_people, {detector}"
        data = self.options.data / "kitchen_people"
        folder, summary = self.run(f"people_{detector}", data, *arguments, "--save-masks")
        found = self.evaluate("masks", data, folder)["frames_over_2_percent"]
        self.row(f"{name}, all frames with people over 2 %, mean IoU", found["mean_iou"], "", iou,
                 most=False)
        self.row(f"{name}, the same, precision", found["mean_precision"], "", precision, most=False)
        self.ate_row(f"{name}, ATE RMSE", summary, 0.020)
        in_map = self.evaluate("run", folder, data)["people_in_map"]
        self.row(f"{name}, confident surfels on people", 100 * in_map["part"], "%", 2, digits=2)
        if detector == "embedded":
            self.row(f"{name}, detector beside the other stages, median",
                     summary["stages"]["pose"]["median_ms"], "ms", digits=2)

    def empty_scenes(self):
        """Where there are no people, everything masked is wrong."""
        sources = {name: self.simulated(name, 1, SECONDS) for name in ("empty_room", "lab")}
        sources["kitchen_static"] = self.options.data / "kitchen_static"
        for name, source in sources.items():
            _, summary = self.run(f"{name}_embedded", source, *EMBEDDED)
            share = summary["masks"]["frames_over_1_percent"] / summary["frames"]["read"]
            self.row(f"{name}, embedded, frames with more than 1 % masked", 100 * share, "%", 5, digits=1)

    def simulated_people(self):
        for seed in self.options.seeds:
            for scenario in MOVING:
                folder = self.masked_run(scenario, seed, SECONDS, "embedded", EMBEDDED)
                found = self.evaluate("masks", self.simulated(scenario, seed, SECONDS), folder)
                self.row(f"{scenario} {seed}, embedded, mean IoU",
                         found["frames_over_2_percent"]["mean_iou"], "", 0.80, most=False, digits=3)
            note("counting simulated people that are found")
            said = call(PROGRAMS / "posefusion_measure_detector", *MOVING, "--seed", seed, *EMBEDDED)
            time, total = said.splitlines()[-2:]
            part = total.split("(")[1].split("%")[0]
            self.row(f"simulated people {seed}, embedded, found", float(part), "%", 95, most=False,
                     digits=1)
            self.row(f"simulated people {seed}, embedded, detector with nothing beside it, median",
                     float(time.split("detector ")[1].split(" ms")[0]), "ms", 6, digits=2)

    def masked_run(self, scenario, seed, seconds, detector, arguments):
        sequence = self.simulated(scenario, seed, seconds)
        return self.run(f"{sequence.name}_{detector}_masks", sequence, *arguments, "--save-masks")[0]

    def people_in_map(self):
        detectors = [("embedded", EMBEDDED)]
        if self.options.model.exists():
            detectors.append(("network", self.network_arguments()))
        for detector, arguments in detectors:
            chair = self.masked_run("walking_xyz", 1, 5, detector, arguments)
            found = self.evaluate("masks", self.simulated("walking_xyz", 1, 5), chair)
            self.row(f"walking_xyz, first 5 s, {detector}, mean IoU",
                     found["frames_over_2_percent"]["mean_iou"], "", 0.80, most=False, digits=3)
            folder = self.masked_run("walking_xyz", 1, 30, detector, arguments)
            in_map = self.evaluate("run", folder, self.simulated("walking_xyz", 1, 30))
            self.row(f"walking_xyz, {detector}, confident surfels on people",
                     100 * in_map["people_in_map"]["part"], "%", 1.5, digits=2)

    def people_speed(self):
        """In turns: the chain with either detector, and the network of an older build."""
        data = self.options.data / "kitchen_people"
        gains, ratios = [], []
        for i in range(self.options.repeats):
            own = self.run(f"chain_embedded_{i}", data, *EMBEDDED)[1]
            network = self.run(f"chain_network_{i}", data, *self.network_arguments())[1]
            gains.append(own["frames_per_second"] / network["frames_per_second"])
            if not self.options.baseline:
                continue
            note("running the older build")
            folder = self.output / "baseline_network"
            shutil.rmtree(folder, ignore_errors=True)
            call(self.options.baseline / "posefusion_run", data, "--output", folder,
                 *self.network_arguments())
            before = json.loads((newest(folder) / "summary.json").read_text())
            ratios.append(network["stages"]["pose"]["median_ms"] / before["stages"]["pose"]["median_ms"])
        self.row("kitchen_people, whole chain, embedded against network", statistics.median(gains), "x",
                 0.85, most=False, digits=2)
        if ratios:
            self.row("pose network, median a detection, against the older build",
                     statistics.median(ratios), "x", 0.65, digits=2)

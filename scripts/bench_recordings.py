# SPDX-License-Identifier: BSD-3-Clause
"""Accuracy, masks and map on a small simulated room and on the test data."""
import json
import shutil

from bench_runs import Runs

CAMERA_OF_FIVE_PEOPLE = ("width: 640\nheight: 480\nfx: 525\nfy: 525\ncx: 319.5\ncy: 239.5\n"
                         "depth_factor: 1000\n")


class Recordings(Runs):
    def box(self):
        small = "--set", "frame.shrink=1"  # the images are small already
        for name in ("empty_box", "box_walker"):
            sequence = self.simulated(name, 1)
            folder, summary = self.run(name, sequence, "--detector", "recorded", "--save-masks", *small)
            self.ate_row(f"{name}, pfh, ATE RMSE", summary, 0.015)
            self.wrong_rows(name, summary)
        _, elastic = self.run("box_walker_elastic", sequence, "--mode", "elastic", *small)
        self.ate_row("box_walker, elastic, ATE RMSE", elastic)
        self.row("box_walker, all frames with people over 2 %, mean IoU",
                 self.evaluate("masks", sequence, folder)["frames_over_2_percent"]["mean_iou"], "")

    def kitchen_static(self):
        folder, summary = self.network("static", "kitchen_static", "--check-depth")
        self.ate_row("kitchen_static, pfh, ATE RMSE", summary, 0.020)
        self.wrong_rows("kitchen_static", summary)
        self.row("kitchen_static, pfh, frames lost", summary["frames"]["lost"], "", 0, digits=0)
        live = summary["depth_median_difference_m"]
        self.row("kitchen_static, depth against the model, median, frames 50-300", 1e3 * live, "mm", 6,
                 digits=2)
        final = self.evaluate("run", folder, self.options.data / "kitchen_static")["depth"]
        self.row("kitchen_static, the same against the final map",
                 1e3 * final["median_abs_difference_m"], "mm", digits=2)
        falsely = summary["masks"]["mean_part"] * summary["masks"]["frames"] / summary["frames"]["read"]
        self.row("kitchen_static, pixels falsely masked, mean", 100 * falsely, "%", 1, digits=2)

    def kitchen_people(self):
        data = self.options.data / "kitchen_people"
        folder, people = self.network("people", "kitchen_people")
        _, static = self.network("static_240", "kitchen_static", "--max-frames", "240")
        self.ate_row("kitchen_people, pfh, ATE RMSE", people, 0.018)
        self.wrong_rows("kitchen_people", people)
        self.row("kitchen_people, pfh, frames lost", people["frames"]["lost"], "", 0, digits=0)
        self.row("kitchen_people, pfh, ATE against the same frames of kitchen_static",
                 people["ate_rmse_m"] / static["ate_rmse_m"], "x", 1.15, digits=2)
        _, elastic = self.run("people_elastic", data, "--mode", "elastic")
        self.ate_row("kitchen_people, elastic, ATE RMSE", elastic)
        check = self.evaluate("run", folder, data)["people_in_map"]
        self.row("kitchen_people, confident surfels on people", 100 * check["part"], "%", 2, digits=2)
        self.mask_rows(folder, "", bars=True)
        paper, _ = self.network("people_paper", "kitchen_people", "--set", "segmentation.energy=paper")
        self.mask_rows(paper, ", the paper's terms", bars=False)

    def masks(self, source, name, folder=None):
        """Agreement of a run's masks with the true ones."""
        truth = (folder or self.options.data) / source
        return self.evaluate("masks", truth, self.output / name)

    def mask_rows(self, folder, which, bars):
        found = self.evaluate("masks", self.options.data / "kitchen_people", folder)
        everybody = found["frames_over_2_percent"]
        self.row(f"kitchen_people, people found by the network{which}, mean IoU",
                 found["found_people"]["mean_iou"], "", 0.85 if bars else None, most=False)
        self.row(f"kitchen_people, all frames with people over 2 %{which}, mean IoU",
                 everybody["mean_iou"], "", 0.65 if bars else None, most=False)
        self.row(f"kitchen_people, all frames with people over 2 %{which}, precision",
                 everybody["mean_precision"], "", 0.90 if bars else None, most=False)

    def five_people(self):
        folder = self.output / "five_people_input"
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir()
        for name in ("color.png", "depth.png"):
            shutil.copyfile(self.options.data / "people_rgbd" / "five_people" / name, folder / name)
        (folder / "associations.txt").write_text("1.0 color.png 1.0 depth.png\n")
        (folder / "camera.yaml").write_text(CAMERA_OF_FIVE_PEOPLE)
        for detector, arguments in (("network", self.network_arguments()),
                                    ("embedded", ("--detector", "embedded"))):
            out, summary = self.run(f"five_people_{detector}", folder, *arguments, "--save-masks")
            people = json.loads((out / "people.json").read_text())["frames"][0]["people"]
            self.fact(f"five_people, {detector}, people found", len(people) == 5, str(len(people)))
            self.row(f"five_people, {detector}, masked", 100 * summary["masks"]["mean_part"],
                     "% of pixels", digits=1)

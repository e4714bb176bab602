# SPDX-License-Identifier: BSD-3-Clause
"""scripts/campaign on small simulated recordings: killed and continued, it gives the results of single runs."""
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent
PROGRAMS = pathlib.Path(os.environ["POSEFUSION_PROGRAMS"])
CAMPAIGN = ROOT / "scripts" / "campaign"
SMALL = ("--set camera.width=160 --set camera.height=120 --set depth.disparity_steps=32 --set depth.lateral=0.25 "
         "--set color.samples=1")
SECONDS, SEEDS = 0.6, (1, 2)
SETTINGS = {"as_it_is": "", "no_people": "--detector none"}
FILES = ("trajectory.txt", "trajectory_live.txt", "map.ply")
PATIENCE_S = 300


def plan_text(more=""):
    settings = "".join(f"  {name}: {words}\n" for name, words in SETTINGS.items())
    return (f"recordings:\n- scenario: box_walker\n  seeds: {list(SEEDS)}\n  duration_s: {SECONDS}\n  arguments: {SMALL}\n"
            f"{more}settings:\n{settings}")


class Campaign(unittest.TestCase):
    def setUp(self):
        if not shutil.which("snakemake"):
            self.skipTest("skipped: no snakemake")
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = pathlib.Path(folder.name)
        self.file = self.root / "small.yaml"
        self.file.write_text(plan_text())

    def command(self, output, *more):
        return [sys.executable, str(CAMPAIGN), str(self.file), "--no-build", "--cores", "2", "--output",
                str(self.root / output), *more]

    def call(self, output, *more, expect=0):
        done = subprocess.run(self.command(output, *more), stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                              timeout=PATIENCE_S, check=False)
        self.assertEqual(done.returncode, expect, done.stdout)
        return done.stdout

    def figures(self, output):
        return sorted((self.root / output).glob("figures/*/*.json"))

    def kill_when(self, output, condition):
        """Kills it and all its children, as a power cut would."""
        with open(self.root / "killed.log", "a", encoding="utf-8") as log:
            process = subprocess.Popen(self.command(output), stdout=log, stderr=log, start_new_session=True)
        end = time.monotonic() + PATIENCE_S
        while not condition() and process.poll() is None and time.monotonic() < end:
            time.sleep(0.02)
        self.assertIsNone(process.poll(), (self.root / "killed.log").read_text())
        os.killpg(process.pid, signal.SIGKILL)
        process.wait()

    def check_whole(self, output):
        for folder in (self.root / output).glob("runs/*/[!.]*"):
            for name in (*FILES, "map.pfdb", "summary.json"):
                self.assertTrue((folder / name).is_file(), folder / name)
        for folder in (self.root / output).glob("recordings/[!.]*"):
            if any(folder.iterdir()):
                self.assertTrue((folder / "groundtruth.txt").is_file(), folder)

    def test_killed_twice_it_gives_the_results_of_single_runs(self):
        self.kill_when("killed", lambda: any((self.root / "killed").glob("recordings/.*.part/*")))
        self.check_whole("killed")
        self.kill_when("killed", lambda: len(self.figures("killed")) >= 1)
        self.check_whole("killed")
        before = {file: file.stat().st_mtime_ns for file in self.figures("killed")}
        self.assertLess(len(before), 4)
        self.call("killed")
        self.check_whole("killed")
        self.assertEqual(len(self.figures("killed")), len(SEEDS) * len(SETTINGS))
        for file, when in before.items():
            self.assertEqual(file.stat().st_mtime_ns, when, "what was there is not run again")
        self.call("whole", "--cores", "1")
        self.assertEqual((self.root / "killed/campaign.csv").read_bytes(), (self.root / "whole/campaign.csv").read_bytes())
        for seed in SEEDS:
            self.compare_with_a_run_by_hand(f"box_walker_{seed}", seed)
        self.assertIn("4 of 4 runs are there", self.call("killed"))

    def compare_with_a_run_by_hand(self, name, seed):
        subprocess.run([PROGRAMS / "posefusion_simulate", "box_walker", "--seed", str(seed), "--duration", str(SECONDS),
                        *SMALL.split(), "--output", self.root / name], stdout=subprocess.DEVNULL, check=True)
        for setting, words in SETTINGS.items():
            by_hand = self.root / "by_hand" / name / setting
            subprocess.run([PROGRAMS / "posefusion_run", self.root / name, "--output", by_hand, *words.split()],
                           stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=True)
            for file in FILES:
                self.assertEqual((self.root / "killed/runs" / name / setting / file).read_bytes(),
                                 (by_hand / "latest" / file).read_bytes(), f"{name} {setting} {file}")

    def test_failures_stand_in_the_table_and_are_tried_again(self):
        broken = self.root / "broken"
        broken.mkdir()
        self.file.write_text(plan_text("- broken\n").replace("seeds: [1, 2]", "seeds: [1]"))
        text = self.call("some", expect=1)
        self.assertIn("campaign: broken/no_people: posefusion_run: ", text)
        table = (self.root / "some/campaign.csv").read_text()
        self.assertIn("ate_m,broken,no_people,failed", table)
        self.assertRegex(table, r"ate_m,box_walker_1,no_people,own,0\.\d+")
        self.assertIn("<h2>ATE RMSE", (self.root / "some/index.html").read_text())
        self.assertIn("| box_walker_1 |", (self.root / "some/campaign.md").read_text())
        self.assertIn("2 of 4 runs are there", self.call("some", expect=1))

    def test_what_is_wrong_in_the_file_is_named(self):
        for text, said in (("- a", "expected recordings and settings"), ("recordings: [none]", "none does not exist"),
                           ("recordings: [{scenario: box_walker, seed: 1}]", "seed is unknown, expected some of "),
                           ("recordings: [{scenario: box_walker, seeds: all}]", "seeds are 'all', expected a list"),
                           ("recordings: [{name: x}]", "expected a path, or a path or a scenario"),
                           ("recordings: [.]\nsettings: {a/b: ''}", "the name 'a/b': expected letters"),
                           ("recordings: [.]\nsettings: {a: {b: 1}}", "settings: a is {'b': 1}, expected arguments"),
                           ("recordings: [", "while parsing")):
            self.file.write_text(text)
            self.assertIn(said, self.call("wrong", expect=1), text)
            self.assertFalse((self.root / "wrong").exists(), "nothing was begun")


if __name__ == "__main__":
    unittest.main()

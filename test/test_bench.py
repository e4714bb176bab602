# SPDX-License-Identifier: BSD-3-Clause
"""scripts/bench: what it reads, keeps and writes. Nothing is measured."""
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent


class Bench(unittest.TestCase):
    def setUp(self):
        sys.path.insert(0, str(ROOT / "scripts"))
        self.addCleanup(sys.path.remove, str(ROOT / "scripts"))

    def test_a_sequence_is_made_again_only_for_its_own_scenario_and_arguments(self):
        from bench_runs import fingerprint
        self.assertEqual(fingerprint("walking_xyz", ["a"]), fingerprint("walking_xyz", ["a"]))
        self.assertNotEqual(fingerprint("walking_xyz", ["a"]), fingerprint("walking_xyz", ["b"]))
        self.assertNotEqual(fingerprint("walking_xyz", ["a"]), fingerprint("loop_room", ["a"]))

    def test_tables_replace_those_of_their_own_parts_alone(self):
        from bench_report import write_markdown
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder, "b.md")
            path.write_text("# Head\n\nText.\n")
            write_markdown(path, {"walk": [("one", "1 m", "<= 2", True)], "gate": None}, "Commit 1.")
            write_markdown(path, {"walk": None, "gate": [("two", "3 m", "<= 2", False)]}, "Commit 2.")
            walk = "### walk\n\nCommit 1.\n\n| what | measured | bar | |\n|---|---|---|---|\n| one | 1 m | <= 2 | ok |\n"
            gate = "\n### gate\n\nCommit 2.\n\n| what | measured | bar | |\n|---|---|---|---|\n| two | 3 m | <= 2 | missed |\n"
            self.assertEqual(path.read_text(), "# Head\n\nText.\n\n## Results\n\n" + walk + gate)
            write_markdown(path, {"walk": [("three", "1 m", "", None)], "gate": None}, "Commit 3.")
            text = path.read_text()
            self.assertNotIn("one", text)
            self.assertIn("Commit 3.", text)
            self.assertTrue(text.endswith(gate), text)

    def test_live_figures_stand_beside_final_ones(self):
        from bench_runs import Runs

        class Options:
            output = pathlib.Path(tempfile.gettempdir())

        runs = Runs(Options)
        runs.print_row = lambda row: None
        summary = {"ate_rmse_m": 0.026, "wrong_poses": 0, "false_poses": 9,
                   "live": {"ate_rmse_m": 0.094, "wrong_poses": 30, "false_poses": 915}}
        runs.ate_row("a walk, ATE", summary, 0.05, digits=3)
        runs.wrong_rows("a walk", summary)
        self.assertEqual(runs.rows, [
            ("a walk, ATE", "0.026 m; live 0.094", "<= 0.05", True),
            ("a walk, wrong poses", "0; live 30", "<= 0", True),
            ("a walk, false poses", "9; live 915", "", None)])
        del summary["live"], runs.rows[:]
        runs.ate_row("a run whose poses nothing corrects", summary)
        self.assertEqual(runs.rows[0][1], "0.0260 m")

    def test_what_becomes_of_live_frames_is_read_from_the_feeder(self):
        from bench_live import understand
        said = ("[INFO]: 900 frames sent, 664 fused, 236 dropped: fusion fell behind; from frame to TF 80.1 ms median, "
                "99.0 ms 99 %")
        self.assertEqual(understand(said), (
            {"sent": 900, "fused": 664, "dropped: fusion fell behind": 236}, 80.1, 99.0))

    def test_transforms_and_topics_that_cross_are_seen(self):
        from bench_soak import crossed_topics, crossed_transforms
        text = "".join(f'frame_id: "{parent}"\n    child_frame_id: "{child}"\n'
                       for parent, child in (("left_map", "left_eye"), ("right_map", "right_eye")))
        self.assertEqual(crossed_transforms(text, ("left", "right")), set())
        self.assertEqual(crossed_transforms(text.replace("right_map", "left_map"), ("left", "right")),
                         {"left_map -> right_eye", "right_map -> right_eye"})

        class Session:
            class master:
                @staticmethod
                def getSystemState(_):
                    mask = ["/left/mask", ["/left/segmenter"]]
                    return 1, "", [[mask], [["/left/mask", ["/right/fusion"]], ["/tf", ["/right/fusion"]]], []]

        self.assertEqual(crossed_topics(Session, ("left", "right")), {"/left/mask"})

    def test_falls_are_of_all_kinds_and_the_same_every_time(self):
        from bench_falls import fall_clips
        clips = fall_clips()
        self.assertEqual(clips, fall_clips())
        falls = [json.loads(value.split("=", 1)[1])[0] for clip in clips for value in clip
                 if value.startswith("camera.falls=")]
        self.assertEqual(len(falls), 20)
        self.assertEqual({fall["to"] for fall in falls}, {"forward", "backward", "sideways"})
        turns = [fall["turn_deg"] for fall in falls]
        self.assertTrue(-90 <= min(turns) < -60 and 60 < max(turns) <= 90, turns)
        self.assertTrue(all(0 <= fall["skip_m"] <= 0.8 for fall in falls))

    def test_a_part_of_a_sequence_has_its_frames_alone(self):
        from bench_merge import part_of
        with tempfile.TemporaryDirectory() as folder:
            whole = pathlib.Path(folder, "whole")
            whole.mkdir()
            lines = [f"{i} rgb/{i}.png {i} depth/{i}.png\n" for i in range(10)]
            (whole / "associations.txt").write_text("# head\n" + "".join(lines))
            (whole / "camera.yaml").write_text("width: 4\n")
            for _ in range(2):  # a second time it is made anew
                part = part_of(whole, pathlib.Path(folder, "part"), 0.2, 0.5)
                self.assertEqual((part / "associations.txt").read_text(), "".join(lines[2:5]))
                self.assertEqual((part / "camera.yaml").read_text(), "width: 4\n")

    def test_places_are_compared_by_distance_and_angle(self):
        from bench_maps import is_far, poses
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder, "t.txt")
            path.write_text("# head\n1.0 0 0 0 0 0 0 1\n2.0 0 0 0.09 0 0 0 -1\n3.0 0 0 0.11 0 0 0 1\n"
                            "4.0 0 0 0 0 0 0.0523 0.99863\n5.0 0 0")
            known = poses(path)
        self.assertEqual(list(known), ["1.0", "2.0", "3.0", "4.0"], "the last line is half written")
        self.assertEqual([is_far(known["1.0"], pose) for pose in known.values()],
                         [False, False, True, True], "0, 9, 11 cm, 6 degrees")

    def test_poses_off_by_the_way_between_rooms_alike_are_counted(self):
        from bench_floor import mixed_up
        rooms = [{"name": "a", "low_m": [0, 0], "high_m": [4, 4]},
                 {"name": "b", "low_m": [5, 0], "high_m": [9, 4]},
                 {"name": "c", "low_m": [10, 0], "high_m": [14, 4], "like": "a"}]
        with tempfile.TemporaryDirectory() as folder:
            sequence = pathlib.Path(folder)
            (sequence / "events.json").write_text(json.dumps({"rooms": rooms}))
            # The world is the map, turned by 90 degrees and moved: its y is the world's -x.
            turn = "0 0 0.70710678 0.70710678"
            (sequence / "groundtruth.txt").write_text(
                "".join(f"{t}.0 {x} 1 1.4 {turn}\n" for t, x in ((1, 1), (2, 2), (3, 2), (4, 6), (5, 12.5))))
            (sequence / "estimate.txt").write_text(
                "".join(f"{t}.0 7 {y} 0 0 0 0 1\n" for t, y in ((1, 0), (2, -1), (3, -11), (4, -11), (5, -2))))
            self.assertEqual(mixed_up(sequence, sequence / "estimate.txt"), 2, "those of 3 and 5 s")

    def test_unknown_parts_are_refused(self):
        done = subprocess.run([str(ROOT / "scripts" / "bench"), "--only", "walk,wlak"],
                              stderr=subprocess.PIPE, text=True)
        self.assertEqual(done.returncode, 2)
        self.assertIn("no part is called wlak", done.stderr)


if __name__ == "__main__":
    unittest.main()

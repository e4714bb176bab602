# SPDX-License-Identifier: BSD-3-Clause
"""Parts of scripts/report: names, cells, the literature, downloads. Nothing is run."""
import functools
import hashlib
import http.server
import io
import json
import pathlib
import subprocess
import sys
import tarfile
import tempfile
import threading
import unittest
import zipfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
SCRIPTS = str(ROOT / "scripts")
LITERATURE = json.loads((ROOT / "config" / "report" / "literature.json").read_text())


class Quiet(http.server.SimpleHTTPRequestHandler):
    def log_message(self, *_):
        pass


class Parts(unittest.TestCase):
    def setUp(self):
        sys.path.insert(0, SCRIPTS)
        self.addCleanup(sys.path.remove, SCRIPTS)

    def results(self, *ates):
        return [{"failed": "it broke"} if ate is None else
                {"final": {"ate_m": ate, "coverage": 0.98}, "live": {"ate_m": 2 * ate}} for ate in ates]

    def test_sequences_are_called_as_in_the_literature(self):
        from report_sequences import literature_name
        for name, simulated, expected in (("rgbd_dataset_freiburg3_walking_xyz", False, "walking_xyz"),
                                          ("rgbd_dataset_freiburg3_walking_xyz.bag", False, "walking_xyz"),
                                          ("rgbd_dataset_freiburg1_desk", False, "fr1_desk"), ("fr2_xyz", False, "fr2_xyz"),
                                          ("rgbd_dataset_freiburg3_long_office_household", False, "fr3_office"),
                                          ("rgbd_bonn_crowd2", False, "crowd2"), ("walking_xyz_1_30s", True, "walking_xyz"),
                                          ("hrpslam1_1_setfps15", True, "hrpslam1"), ("my_room", False, "my_room")):
            self.assertEqual(literature_name(name, simulated), expected)

    def test_cells_cover_all_runs(self):
        from report_tables import error_cell
        cell = error_cell(self.results(0.3, 0.1, 0.2), "ate_m", 2, "own")
        self.assertEqual((cell.text, cell.value, cell.live, cell.least, cell.most, cell.runs),
                         ("0.20", 0.2, 0.4, 0.1, 0.3, 3))
        self.assertEqual(cell.details, ("live 0.40", "98.0 % of frames", "0.10 to 0.30"))
        alike = error_cell(self.results(0.1, 0.1), "ate_m", 2, "own")
        self.assertEqual(alike.details, ("live 0.20", "98.0 % of frames"), "nothing varies")
        some = error_cell(self.results(0.1, None), "ate_m", 2, "own")
        self.assertEqual((some.text, some.details[-1]), ("0.10", "1 of 2 runs failed"))
        none = error_cell(self.results(None), "ate_m", 2, "own")
        self.assertEqual((none.text, none.kind, none.note, none.value), ("failed", "failed", "it broke", None))

    def test_a_link_leads_where_its_name_says(self):
        from report_html import link
        self.assertEqual(link("runs/a b/view.html", "a < b"), '<p><a href="runs/a%20b/view.html">a &lt; b</a></p>')

    def test_the_literature_has_sources_and_known_names(self):
        from report_sequences import literature_name
        for entry in LITERATURE["figures"]:
            self.assertTrue(entry["source"] and entry["system"] and entry["values"], entry)
            self.assertIn(entry["of"], ("ate_m", "rpe_m_s", "removed", "loops"))
        paper = next(e for e in LITERATURE["figures"] if e["system"].startswith("PFH") and e["of"] == "rpe_m_s")
        marked = {name for name, value in paper["values"].items() if isinstance(value, dict)}
        self.assertEqual(marked, {"walking_xyz", "walking_halfsphere"})
        archives = json.loads((ROOT / "config" / "report" / "archives.json").read_text())
        known = {name for entry in LITERATURE["figures"] for name in entry["values"]}
        for entry in archives["tum"] + archives["bonn"]:
            self.assertIn(literature_name(entry["name"], False), known)

    def test_the_papers_figures_stand_beside_marked(self):
        from report_html import page
        from report_sequences import Sequence
        from report_tables import Tables
        from report_text import latex, markdown
        sequence = Sequence("walking_xyz", pathlib.Path("nowhere"), True)
        results = {(sequence.key, "pfh"): [{"failed": "no frames"}]}
        tables = Tables([sequence], ["pfh"], [], results, LITERATURE).all()
        rpe = next(table for table in tables if table.name == "rpe_second")
        cell = dict(zip(rpe.columns, rpe.rows[0][1]))["PFH, the paper"]
        self.assertEqual((cell.text, cell.value, cell.kind), ("0.0211", 0.0211, "literature"))
        self.assertIn("read as cm/s", cell.details[0])
        self.assertIn("the real recording", cell.note)
        self.assertIn("walking_xyz (simulated)", rpe.rows[0][0])
        text = page(tables, [], [])
        self.assertRegex(text, r'<td class="literature"[^>]*>0\.0211<sup>')
        self.assertRegex(markdown(tables, []), r"\*0\.0211\* \[\d+\]")
        self.assertIn(r"\textcolor{gray}{0.0211}", latex(tables, []))

    def test_drawings_hide_neither_peaks_nor_gaps(self):
        from report_plot import nice, peaks, thinned, without_gaps
        track = [(i, 0, 0, 1.0 if i == 4321 else 0.0) for i in range(10000)]
        self.assertEqual(max(row[3] for row in peaks(track)), 1.0)
        self.assertLessEqual(len(peaks(track)), 700)
        points = thinned([(i, i, i) for i in range(10000)])
        self.assertEqual((points[0][0], points[-1][0]), (0, 9999))
        self.assertEqual([len(part) for part in without_gaps([(0,), (0.1,), (0.2,), (3,), (3.4,)])], [3, 2])
        self.assertEqual(without_gaps([]), [])
        self.assertEqual([nice(v) for v in (1, 3, 7, 0.25)], [1, 2, 5, 0.2])


class Download(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = pathlib.Path(folder.name)
        (self.root / "www").mkdir()
        handler = functools.partial(Quiet, directory=str(self.root / "www"))
        self.server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler)
        threading.Thread(target=self.server.serve_forever, daemon=True).start()
        self.addCleanup(self.server.server_close)
        self.addCleanup(self.server.shutdown)

    def put(self, name, sequence, member="rgb.txt"):
        """An archive on the server; the entry of the list."""
        file, text = self.root / "www" / name, b"# color images\n"
        if name.endswith(".zip"):
            with zipfile.ZipFile(file, "w") as archive:
                archive.writestr(f"{sequence}/{member}", text)
        else:
            with tarfile.open(file, "w:gz") as archive:
                info = tarfile.TarInfo(f"{sequence}/{member}")
                info.size = len(text)
                archive.addfile(info, io.BytesIO(text))
        return {"name": sequence, "url": f"http://127.0.0.1:{self.server.server_address[1]}/{name}",
                "sha256": hashlib.sha256(file.read_bytes()).hexdigest()}

    def download(self, *entries):
        archives = self.root / "archives.json"
        archives.write_text(json.dumps({"tum": entries, "bonn": []}))
        done = subprocess.run([str(ROOT / "scripts" / "report"), "--download", "tum", "--no-runs", "--archives", str(archives),
                               "--data", str(self.root / "data"), "--output", str(self.root / "output")],
                              stderr=subprocess.PIPE, text=True)
        there = {p.name for p in (self.root / "data").iterdir() if p.is_dir()}
        return done.returncode, there, done.stderr

    def test_archives_are_fetched_once_and_unpacked(self):
        entries = self.put("a.tgz", "rgbd_dataset_freiburg3_a"), self.put("b.zip", "rgbd_bonn_b")
        code, there, said = self.download(*entries)
        self.assertEqual((code, there), (0, {"rgbd_dataset_freiburg3_a", "rgbd_bonn_b"}), said)
        self.assertTrue((self.root / "data" / "rgbd_bonn_b" / "rgb.txt").is_file())
        for file in (self.root / "www").iterdir():
            file.unlink()
        self.assertEqual(self.download(*entries)[:2], (0, there), "nothing is fetched again")

    def test_what_is_not_as_it_should_be_is_refused(self):
        wrong = {**self.put("a.tgz", "a"), "sha256": "0" * 64}
        absent = {**wrong, "name": "b", "url": wrong["url"].replace("a.tgz", "none.tgz")}
        outside, empty = self.put("c.tgz", "c", "../../c.txt"), self.put("d.zip", "d", "depth.txt")
        (self.root / "www" / "e.zip").write_bytes(b"no archive")
        broken = {**wrong, "name": "e", "url": wrong["url"].replace("a.tgz", "e.zip"), "sha256": None}
        code, there, said = self.download(wrong, absent, outside, empty, broken)
        self.assertEqual((code, there), (1, set()), said)
        for words in ("expected " + "0" * 64, "404", "no file below it", "0 folders with rgb.txt", "is no archive"):
            self.assertIn(words, said)
        self.assertFalse((self.root / "c.txt").exists())

    def test_an_unknown_checksum_is_remembered(self):
        entry = {**self.put("a.tgz", "a"), "sha256": None}
        self.assertEqual(self.download(entry)[0], 0)
        known = json.loads((self.root / "data" / "checksums.json").read_text())
        self.assertEqual(list(known), [entry["url"]])
        (self.root / "data" / "a" / "rgb.txt").unlink()
        (self.root / "data" / "a").rmdir()
        self.put("a.tgz", "a", "other.txt")
        code, there, said = self.download(entry)
        self.assertEqual((code, there), (1, set()))
        self.assertIn(f"expected {known[entry['url']]}", said)

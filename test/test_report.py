# SPDX-License-Identifier: BSD-3-Clause
"""scripts/report on sequences of a second."""
import csv
import html.parser
import os
import pathlib
import re
import shutil
import subprocess
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent
PROGRAMS = pathlib.Path(os.environ["POSEFUSION_PROGRAMS"])
VARYING = ("speed", "memory")  # tables
VOID = {"meta", "img", "br", "rect", "polyline"}


class Page(html.parser.HTMLParser):
    """What is in a page, and whether its elements are closed."""

    def __init__(self, text):
        super().__init__()
        self.open, self.wrong, self.loaded, self.headings, self.count = [], [], [], [], {}
        self.feed(text)
        self.close()

    def handle_starttag(self, tag, attributes):
        self.count[tag] = self.count.get(tag, 0) + 1
        self.loaded += [v for k, v in attributes if k in ("src", "href", "data", "poster") or k == "style" and "url" in v]
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag, attributes):
        self.handle_starttag(tag, attributes)
        if tag not in VOID:
            self.open.pop()

    def handle_endtag(self, tag):
        if not self.open or self.open.pop() != tag:
            self.wrong.append(tag)

    def handle_data(self, data):
        if self.open and self.open[-1] in ("h2", "th"):
            self.headings.append(data)


class Report(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.root = pathlib.Path(folder.name)
        for name in ("box_walker", "empty_box"):
            subprocess.run([PROGRAMS / "posefusion_simulate", name, "--duration", "0.7", "--output",
                            cls.root / f"{name}_1"], stdout=subprocess.DEVNULL, check=True)
        broken = cls.root / "broken"
        shutil.copytree(cls.root / "empty_box_1", broken)
        (broken / "camera.yaml").write_text("width: 3\n")
        others = cls.root / "others"
        (others / "rounded").mkdir(parents=True)
        (others / "empty").mkdir()
        rows = (cls.root / "box_walker_1" / "groundtruth.txt").read_text().splitlines()[2:]
        (others / "rounded" / "box_walker.txt").write_text(
            "".join(f"{float(row.split()[0]):.3f} {row.split(' ', 1)[1]}\n" for row in rows[:len(rows) // 2]))
        cls.code, cls.said, cls.wrong = cls.report("one", "box_walker_1", "empty_box_1", "broken", "nowhere")
        cls.table = cls.values("one")

    @classmethod
    def report(cls, output, *words):
        command = [str(ROOT / "scripts" / "report"), *(str(cls.root / word) for word in words), "--output",
                   str(cls.root / output), "--others", str(cls.root / "others"), "--modes", "elastic,pfh", "--runs", "1",
                   "--set", "frame.shrink=1", "--no-build"]
        done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        return done.returncode, done.stdout, done.stderr

    @classmethod
    def values(cls, output):
        with open(cls.root / output / "report.csv", newline="") as file:
            return list(csv.DictReader(file))

    def cell(self, table, sequence, system):
        found = [row for row in self.table if (row["table"], row["system"]) == (table, system)
                 and row["sequence"].startswith(sequence)]
        self.assertEqual(len(found), 1, (table, sequence, system))
        return found[0]

    def test_every_cell_has_a_figure_or_a_reason(self):
        for row in self.table:
            self.assertTrue(row["value"] or row["note"], row)
        self.assertGreater(len(self.table), 60)

    def test_figures_are_those_of_the_runs(self):
        walker = self.cell("ate", "box_walker", "pfh")
        self.assertLess(float(walker["value"]), 0.01)
        self.assertEqual((walker["coverage"], walker["kind"], walker["unit"]), ("1", "own", "m"))
        self.assertGreater(float(self.cell("people", "box_walker", "elastic")["value"]), 1)
        self.assertLess(float(self.cell("people", "box_walker", "pfh")["value"]), 1)
        self.assertEqual(self.cell("rpe_second", "box_walker", "pfh")["note"], "not measured", "0.7 s have none")
        self.assertGreater(float(self.cell("speed", "empty_box", "pfh")["value"]), 1)

    def test_failures_stand_in_the_tables(self):
        self.assertEqual(self.code, 1)
        failed = self.cell("ate", "empty_box", "empty")
        self.assertEqual((failed["kind"], failed["value"], failed["note"]), ("failed", "", "no empty/empty_box.txt"))
        rows = [row for row in self.table if row["sequence"].startswith("broken") and row["system"] == "pfh"]
        self.assertTrue(rows and all(row["kind"] == "failed" and "camera.yaml" in row["note"] for row in rows))
        self.assertIn("nowhere: is no folder, bag or scenario", self.wrong)
        self.assertIn("nowhere: is no folder", (self.root / "one" / "report.md").read_text())

    def test_others_stand_beside_with_their_gaps(self):
        other = self.cell("ate", "box_walker", "rounded")
        self.assertEqual(other["kind"], "other")
        self.assertLess(float(other["value"]), 0.01)
        self.assertTrue(0.3 < float(other["coverage"]) < 0.7, other)

    def test_the_page_needs_nothing_else(self):
        text = (self.root / "one" / "index.html").read_text()
        page = Page(text)
        self.assertEqual((page.open, page.wrong), ([], []))
        self.assertTrue(all(what.startswith("data:image/png;base64,") for what in page.loaded), page.loaded)
        self.assertGreaterEqual(page.count["img"], 2, "masks, map")
        self.assertGreaterEqual(page.count["svg"], 4, "paths and errors of two")
        self.assertNotRegex(text, r"(?i)<script|@import|url\(|https?://(?!www\.w3\.org/2000/svg)")
        self.assertIn('name="viewport"', text)
        for heading in page.headings:
            if re.match("box_walker|empty_box", heading):
                self.assertIn("simulated", heading)
        for fact in ("commit", "machine", "date", "settings"):
            self.assertIn(f"<dt>{fact}</dt>", text)

    def test_latex_is_balanced(self):
        text = (self.root / "one" / "report.tex").read_text()
        self.assertEqual(text.count(r"\begin{"), text.count(r"\end{"))
        self.assertIn(r"box\_walker (simulated) &", text)
        for line in text.splitlines():
            self.assertFalse(re.search(r"(?<!\\)[_#%]", line) and not line.startswith("%"), line)
            columns = re.match(r"\\begin{tabular}{(\w+)}", line)
            width = len(columns.group(1)) if columns else locals().get("width", 0)
            if line.endswith(r"\\"):
                self.assertEqual(len(re.findall(r"(?<!\\)&", line)) + 1, width, line)

    def test_a_second_report_takes_what_is_there(self):
        before = {p: p.stat().st_mtime_ns for p in (self.root / "one" / "runs").rglob("figures.json")}
        texts = {n: (self.root / "one" / n).read_bytes() for n in ("report.csv", "report.md", "report.tex", "index.html")}
        self.assertEqual(len(before), 4)
        self.report("one", "box_walker_1", "empty_box_1", "broken", "nowhere")
        self.assertEqual({p: p.stat().st_mtime_ns for p in before}, before)
        for name, text in texts.items():
            self.assertEqual((self.root / "one" / name).read_bytes(), text, name)

    def test_another_report_differs_in_times_alone(self):
        self.report("two", "box_walker_1")
        mine = [row for row in self.table if row["sequence"].startswith("box_walker") and row["table"] not in VARYING]
        theirs = [row for row in self.values("two") if row["table"] not in VARYING]
        self.assertEqual(theirs, mine)
        file = self.root / "two" / "runs" / "box_walker_simulated" / "pfh_1" / "figures.json"
        stamp = file.stat().st_mtime_ns
        file.write_text(file.read_text().replace('"mode": "pfh"', '"mode": "other"'))
        self.report("two", "box_walker_1")
        self.assertNotEqual(file.stat().st_mtime_ns, stamp, "with other settings it is measured again")

    def test_impossible_arguments_are_refused(self):
        for words, said in ((("--modes", "fast"), "'fast' is none of elastic, posefusion, pfh"),
                            (("--runs", "0"), "--runs is 0"), (("--others", "nowhere"), "is no folder")):
            done = subprocess.run([str(ROOT / "scripts" / "report"), *words], stderr=subprocess.PIPE, text=True)
            self.assertEqual(done.returncode, 2)
            self.assertIn(said, done.stderr)

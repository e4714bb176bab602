# SPDX-License-Identifier: BSD-3-Clause
"""import posefusion: trajectories, their errors, and what the package is made of."""
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

from python_package import BUILT, NOT_BUILT, PACKAGES, PROGRAMS, ROOT, run

if BUILT:
    import numpy
    import posefusion


@unittest.skipUnless(BUILT, NOT_BUILT)
class Package(unittest.TestCase):
    def walk(self, count=40):
        rows = numpy.zeros((count, 8))
        rows[:, 0] = 1341845820.819654 + numpy.arange(count) / 32
        rows[:, 1:4] = numpy.cumsum(numpy.random.RandomState(1).normal(0, 0.1, (count, 3)), axis=0)
        rows[:, 7] = 1
        return rows

    def test_trajectories_come_back_as_they_were_written(self):
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder, "walk.txt")
            rows = self.walk()
            posefusion.write_tum(file, rows, "a walk")
            numpy.testing.assert_allclose(posefusion.read_tum(file), rows, rtol=1e-8)
            self.assertEqual(file.read_text().splitlines()[2].split()[0], "1341845820.819654")
            with self.assertRaisesRegex(ValueError, r"trajectory has the shape \(40, 7\), expected \(N, 8\)"):
                posefusion.write_tum(file, rows[:, :7])
            rows[3, 7] = 2
            with self.assertRaisesRegex(ValueError, "trajectory, row 3: the quaternion"):
                posefusion.write_tum(file, rows)
            with self.assertRaisesRegex(ValueError, "none.txt"):
                posefusion.read_tum(pathlib.Path(folder, "none.txt"))

    def test_errors_are_those_of_the_program(self):
        truth, estimate = self.walk(), self.walk()
        estimate[:, 1:4] = 0.5 * estimate[:, 1:4] + numpy.random.RandomState(2).normal(0, 0.02, (40, 3))
        with tempfile.TemporaryDirectory() as folder:
            files = [pathlib.Path(folder, name) for name in ("truth.txt", "estimate.txt")]
            for file, rows in zip(files, (truth, estimate)):
                posefusion.write_tum(file, rows)
            said = run(PROGRAMS / "posefusion_evaluate", "trajectory", *files, "--align", "similarity", "--step", 5,
                       "--json")
        ate = posefusion.evaluate.ate(truth, estimate, align="similarity")
        rpe = posefusion.evaluate.rpe(truth, estimate, step=5, align="similarity")
        for name, value in (("scale", ate.scale), ("ate_m", ate.translation_m.rmse), ("rpe_m", rpe.translation_m.sse)):
            printed = float(re.search(rf'"{name}": (?:{{[^}}]*"{"sse" if name == "rpe_m" else "rmse"}": )?([\d.e-]+)',
                                      said).group(1))
            self.assertAlmostEqual(printed, value, delta=1e-6, msg=name)
        with self.assertRaisesRegex(ValueError, "alignment is 'affine'"):
            posefusion.evaluate.ate(truth, estimate, align="affine")
        with self.assertRaisesRegex(ValueError, "step is"):
            posefusion.evaluate.rpe(truth, estimate, step=0)
        with self.assertRaisesRegex(ValueError, "only 0 estimated poses"):
            posefusion.evaluate.ate(truth, estimate, offset=100)

    def test_stubs_name_what_there_is(self):
        from posefusion import _core
        stub = (ROOT / "python" / "posefusion" / "_core.pyi").read_text()
        declared = set(re.findall(r"^(?:class|def) (\w+)", stub, re.MULTILINE))
        self.assertEqual(declared, {name for name in dir(_core) if not name.startswith("_")})
        for kind, body in re.findall(r"^class (\w+)[^\n]*\n((?:    [^\n]*\n|\n)*)", stub, re.MULTILINE):
            members = set(re.findall(r"^    (?:def )?(\w+)[:(]", body, re.MULTILINE)) - {"__init__"}
            found = {name for name in dir(getattr(_core, kind)) if not name.startswith("_")}
            self.assertEqual({m for m in members if not m.startswith("_")},
                             found if kind != "InputError" else set(), kind)
        shown = set(re.findall(r" as (\w+)", (ROOT / "python" / "posefusion" / "__init__.pyi").read_text()))
        self.assertEqual(shown, {name for name in dir(posefusion) if not name.startswith("_")} - {"importlib", "msg", "srv"})

    def test_messages_need_no_core(self):
        code = "import posefusion.msg, sys; assert 'posefusion._core' not in sys.modules; print(posefusion.msg.Person)"
        environment = {**os.environ, "PYTHONPATH": f"{PACKAGES}:{os.environ.get('PYTHONPATH', '')}"}
        done = subprocess.run(["/usr/bin/python3", "-c", code], env=environment, stdout=subprocess.PIPE, text=True)
        self.assertEqual(done.returncode, 0)
        self.assertIn("_Person", done.stdout)

    def test_the_example_maps_a_folder(self):
        with tempfile.TemporaryDirectory() as folder:
            sequence, output = (pathlib.Path(folder, name) for name in ("sequence", "output"))
            run(PROGRAMS / "posefusion_simulate", "empty_box", "--duration", 0.5, "--output", sequence)
            environment = {**os.environ, "PYTHONPATH": str(PACKAGES)}
            done = subprocess.run([sys.executable, str(ROOT / "examples" / "map_tum_folder.py"), str(sequence),
                                   str(output)], env=environment, stdout=subprocess.PIPE, text=True)
            self.assertEqual(done.returncode, 0)
            self.assertRegex(done.stdout, r"15 frames, 15 poses, \d+ surfels\nATE 0\.00\d+ m\n")
            self.assertTrue((output / "map.ply").is_file())

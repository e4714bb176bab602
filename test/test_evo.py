# SPDX-License-Identifier: BSD-3-Clause
"""posefusion_evaluate trajectory against evo's formulas, computed here by numpy (M. Grupp, "evo", 2017)."""
import json
import os
import pathlib
import subprocess
import tempfile
import unittest

try:
    import numpy
except ImportError:
    numpy = None

PROGRAMS = pathlib.Path(os.environ["POSEFUSION_PROGRAMS"])
DATA = pathlib.Path(os.environ.get("POSEFUSION_TEST_DATA", "../shared/data")) / "trajectories"
MOST_DIFFERENCE = 1e-4  # m and degrees
STATISTICS = {"rmse": lambda e: numpy.sqrt(numpy.mean(e ** 2)), "mean": lambda e: numpy.mean(e),
              "median": lambda e: numpy.median(e), "std": lambda e: numpy.std(e),
              "min": lambda e: numpy.min(e), "max": lambda e: numpy.max(e),
              "sse": lambda e: numpy.sum(e ** 2)}


def turn(axis_angle):
    """Rotation matrix of a vector, by its length in rad."""
    angle = numpy.linalg.norm(axis_angle)
    x, y, z = axis_angle / max(angle, 1e-12)
    hat = numpy.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return numpy.eye(3) + numpy.sin(angle) * hat + (1 - numpy.cos(angle)) * hat @ hat


def pose(rotation, translation):
    T = numpy.eye(4)
    T[:3, :3], T[:3, 3] = rotation, translation
    return T


def quaternion(R):
    """x y z w; for turns below 180 degrees."""
    w = numpy.sqrt(max(0, 1 + numpy.trace(R))) / 2
    return numpy.array([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1], 4 * w * w]) / (4 * w)


def simulated(seed, length=300, scale=1.0):
    """A walk and an estimate of it: drifting, noisy, in a frame and of a scale of its own."""
    random = numpy.random.RandomState(seed)
    T, drift, truth, estimate = numpy.eye(4), numpy.eye(4), [], []
    other = pose(turn(random.uniform(-1, 1, 3)), random.uniform(-3, 3, 3))
    for _ in range(length):
        truth.append(T)
        found = other @ drift @ T @ pose(turn(random.normal(0, 0.01, 3)), random.normal(0, 0.01, 3))
        found[:3, 3] *= scale
        estimate.append(found)
        T = T @ pose(turn(random.normal(0, 0.02, 3)), [0.04, 0, 0] + random.normal(0, 0.01, 3))
        drift = drift @ pose(turn(random.normal(0, 0.001, 3)), random.normal(0, 0.002, 3))
    return numpy.array(truth), numpy.array(estimate)


def aligned(truth, estimate, how):
    if how == "origin":
        return truth[0] @ numpy.linalg.inv(estimate[0]) @ estimate
    if how == "none":
        return estimate
    x, y = estimate[:, :3, 3], truth[:, :3, 3]  # Umeyama 1991
    u, d, vt = numpy.linalg.svd((y - y.mean(0)).T @ (x - x.mean(0)) / len(x))
    sign = numpy.diag([1, 1, numpy.linalg.det(u) * numpy.linalg.det(vt)])
    R = u @ sign @ vt
    scale = numpy.trace(numpy.diag(d) @ sign) / ((x - x.mean(0)) ** 2).sum(1).mean() \
        if how == "similarity" else 1
    out = estimate.copy()
    out[:, :3, 3] *= scale
    return pose(R, y.mean(0) - scale * R @ x.mean(0)) @ out


def apart(a, b):
    """(m, degrees) of the motions from a to b."""
    E = numpy.linalg.inv(a) @ b
    cosine = numpy.clip((numpy.trace(E[:, :3, :3], axis1=1, axis2=2) - 1) / 2, -1, 1)
    return numpy.linalg.norm(E[:, :3, 3], axis=1), numpy.degrees(numpy.arccos(cosine))


def evo_pairs(poses, step, unit, every):
    if unit == "frames":
        ids = range(len(poses))
        return [(i, i + step) for i in ids if i + step < len(poses)] if every else \
            list(zip(ids[::step], ids[::step][1:]))
    way, ids = 0, []
    for i in range(1, len(poses)):
        way += numpy.linalg.norm(poses[i][:3, 3] - poses[i - 1][:3, 3])
        if way >= step:
            ids.append(i)
            way = 0
    return list(zip(ids, ids[1:]))


def evo(truth, estimate, how, step=1, unit="frames", every=False):
    found = aligned(truth, estimate, how)
    i, j = numpy.array(evo_pairs(found, step, unit, every)).T
    absolute = apart(truth, found)
    relative = apart(numpy.linalg.inv(truth[i]) @ truth[j], numpy.linalg.inv(found[i]) @ found[j])
    return dict(zip(("ate_m", "ate_deg", "rpe_m", "rpe_deg"), absolute + relative))


def evaluate(*words):
    command = [str(word) for word in (PROGRAMS / "posefusion_evaluate", "trajectory", *words)]
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    return done.returncode, done.stdout, done.stderr


def tum(poses):
    return "".join(f"{1341845820 + i / 30:.6f} " + " ".join(f"{v:.12g}" for v in (*T[:3, 3], *quaternion(T[:3, :3])))
                   + "\n" for i, T in enumerate(poses))


def kitti(poses):
    return "".join(" ".join(f"{v:.12g}" for v in T[:3].ravel()) + "\n" for T in poses)


def euroc(poses):
    rows = ["#timestamp,p_RS_R_x [m],p_RS_R_y [m],p_RS_R_z [m],q_RS_w [],q_RS_x [],q_RS_y [],q_RS_z []"]
    for i, T in enumerate(poses):
        q = quaternion(T[:3, :3])
        values = (*T[:3, 3], q[3], *q[:3], 0.5, 0.25)
        rows.append(f"{1341845820000000000 + round(i * 1e9 / 30)}," + ",".join(f"{v:.12g}" for v in values))
    return "\n".join(rows) + "\n"


@unittest.skipUnless(numpy, "skipped: no numpy")
class Evo(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.truth, self.estimate = (pathlib.Path(folder.name, name) for name in ("truth", "estimate"))

    def compare(self, truth, estimate, how, *words, **named):
        code, said, wrong = evaluate(self.truth, self.estimate, "--align", how, "--json", *words)
        self.assertEqual(code, 0, wrong)
        answer = json.loads(said)
        for name, errors in evo(truth, estimate, how, **named).items():
            self.assertEqual(answer[name]["count"], len(errors), name)
            for statistic, formula in STATISTICS.items():
                self.assertAlmostEqual(answer[name][statistic], formula(errors), delta=MOST_DIFFERENCE,
                                       msg=f"{how} {words} {name} {statistic}")

    def test_all_alignments_agree(self):
        for seed, scale in ((1, 1.0), (2, 0.4)):
            truth, estimate = simulated(seed, scale=scale)
            self.truth.write_text(tum(truth))
            self.estimate.write_text(tum(estimate))
            for how in ("none", "rigid", "similarity", "origin"):
                self.compare(truth, estimate, how)

    def test_all_steps_agree(self):
        truth, estimate = simulated(3)
        self.truth.write_text(tum(truth))
        self.estimate.write_text(tum(estimate))
        self.compare(truth, estimate, "rigid", "--step", 7, step=7)
        self.compare(truth, estimate, "rigid", "--step", 7, "--overlapping", step=7, every=True)
        self.compare(truth, estimate, "rigid", "--step", 1, "--step-unit", "metres", step=1, unit="metres")
        self.compare(truth, estimate, "similarity", "--step", 0.5, "--step-unit", "metres", step=0.5, unit="metres")

    def test_all_formats_agree(self):
        truth, estimate = simulated(4)
        for true_text, text in ((kitti, kitti), (euroc, tum), (euroc, euroc), (tum, euroc)):
            self.truth.write_text(true_text(truth))
            self.estimate.write_text(text(estimate))
            self.compare(truth, estimate, "rigid")

    def test_a_clock_offset_is_corrected(self):
        truth, estimate = simulated(5)
        self.truth.write_text(tum(truth))
        self.estimate.write_text("".join(f"{float(line.split(' ', 1)[0]) - 12.5:.6f} {line.split(' ', 1)[1]}"
                                         for line in tum(estimate).splitlines(keepends=True)))
        self.assertEqual(evaluate(self.truth, self.estimate)[0], 1, "no pose has a true one")
        self.compare(truth, estimate, "rigid", "--offset-s", 12.5)

    def test_files_that_do_not_belong_together_are_refused(self):
        truth, estimate = simulated(6, 20)
        self.truth.write_text(kitti(truth))
        self.estimate.write_text(kitti(estimate[:19]))
        code, _, wrong = evaluate(self.truth, self.estimate)
        self.assertEqual(code, 1)
        self.assertIn("19 poses, expected as many", wrong)
        self.estimate.write_text(tum(estimate))
        self.assertEqual(evaluate(self.truth, self.estimate)[0], 1)
        self.estimate.write_text(kitti(estimate))
        self.assertEqual(evaluate(self.truth, self.estimate)[0], 0)
        code, _, wrong = evaluate(self.truth, self.estimate, "--step-unit", "seconds")
        self.assertIn("has no stamps", wrong)
        self.assertEqual(evaluate(self.truth, self.estimate, "--align", "affine")[0], 105)

    @unittest.skipUnless(DATA.is_dir(), f"skipped: no test data at {DATA}")
    def test_known_figures_come_out_to_the_last_digit(self):
        for truth, estimate, pairs, ate_m in (
                ("freiburg1_xyz-groundtruth.txt", "freiburg1_xyz-rgbdslam.txt", 786, 0.013473),
                ("fr2_desk_groundtruth.txt", "fr2_desk_ORB.txt", 2223, 0.008144)):
            code, said, wrong = evaluate(DATA / truth, DATA / estimate, "--json")
            self.assertEqual(code, 0, wrong)
            found = json.loads(said)["ate_m"]
            self.assertEqual((found["count"], round(found["rmse"], 6)), (pairs, ate_m))

# SPDX-License-Identifier: BSD-3-Clause
"""posefusion.Slam: the chain for Python programs."""
import pathlib
import re
import tempfile
import threading
import time
import unittest

from python_package import BUILT, NOT_BUILT, PROGRAMS, run

if BUILT:
    import numpy
    import posefusion

FRAMES = 20
SMALL = {"frame": {"shrink": 1}}  # the images are small already


def poses(path):
    return [line for line in path.read_text().splitlines() if line[0] != "#"]


def memory_mb():
    return int(re.search(r"VmRSS:\s+(\d+)", pathlib.Path("/proc/self/status").read_text()).group(1)) / 1024


@unittest.skipUnless(BUILT, NOT_BUILT)
class Mapping(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.folder.cleanup)
        cls.sequence = pathlib.Path(cls.folder.name, "sequence")
        run(PROGRAMS / "posefusion_simulate", "box_walker", "--duration", FRAMES / 30, "--output", cls.sequence)
        cls.frames = [(f.color, f.depth, f.stamp, f.camera) for f in posefusion.open_folder(cls.sequence)]

    def mapped(self, change=lambda color, depth: (color, depth), after=lambda color, depth: None):
        """A chain over all frames, and its answers."""
        slam, answers = posefusion.Slam(SMALL), []
        for color, depth, stamp, camera in self.frames:
            color, depth = change(color, depth)
            answers.append(slam.process(color, depth, stamp, camera))
            after(color, depth)
        slam.finish()
        return slam, answers

    def test_the_trajectory_is_that_of_the_program(self):
        output = pathlib.Path(self.folder.name, "output")
        run(PROGRAMS / "posefusion_run", self.sequence, "--set", "frame.shrink=1", "--output", output)
        slam, answers = self.mapped()
        saved = pathlib.Path(self.folder.name, "saved")
        surfels = slam.save(saved)
        self.assertEqual(poses(saved / "trajectory.txt"), poses(output / "latest" / "trajectory.txt"))
        self.assertEqual((saved / "map.ply").read_bytes(), (output / "latest" / "map.ply").read_bytes())
        self.assertEqual(len(slam.map()), surfels)
        posed = [a for a in answers if a.T_world_camera is not None]
        self.assertGreater(len(posed), FRAMES // 2)
        self.assertEqual(len(slam.trajectory()), len(posed))
        error = posefusion.evaluate.ate(self.sequence / "groundtruth.txt", slam.trajectory())
        self.assertLess(error.translation_m.rmse, 0.02)

    def test_frames_may_lie_in_memory_in_any_way_and_be_written_over(self):
        def elsewhere(color, depth):
            wide = numpy.zeros((color.shape[0], color.shape[1] + 5, 3), numpy.uint8)
            wide[:, 2:-3] = color
            return wide[:, 2:-3], numpy.asfortranarray(depth)

        def reversed_order(color, depth):
            return color[..., ::-1].copy()[..., ::-1], depth[::-1].copy()[::-1]

        def destroy(color, depth):
            color[...], depth[...] = 77, 1234

        expected = self.mapped()[0].trajectory()
        for change in (elsewhere, reversed_order, lambda c, d: (c.copy(), d.copy())):
            numpy.testing.assert_array_equal(self.mapped(change, destroy)[0].trajectory(), expected)

    def test_depth_in_metres_is_depth_in_steps(self):
        def metres(color, depth):
            return color, depth.astype(numpy.float32) * numpy.float32(0.001)

        poses = self.mapped(metres)[0].trajectory()
        numpy.testing.assert_allclose(poses, self.mapped()[0].trajectory(), atol=1e-3)

    def test_maps_are_arrays(self):
        found = self.mapped()[0].map()
        count = len(found)
        self.assertGreater(count, 1000)
        for array, shape, kind in ((found.points, (count, 3), numpy.float32), (found.normals, (count, 3), numpy.float32),
                                   (found.colors, (count, 3), numpy.uint8), (found.radii, (count,), numpy.float32),
                                   (found.confidences, (count,), numpy.float32)):
            self.assertEqual((array.shape, array.dtype), (shape, kind))
        numpy.testing.assert_allclose(numpy.linalg.norm(found.normals, axis=1), 1, atol=1e-3)
        self.assertTrue((found.radii > 0).all())
        self.assertIs(found.points, found.points, "no copy each time")

    def test_answers_have_pose_and_covariance(self):
        answers = self.mapped()[1]
        self.assertEqual(answers[-1].status, "tracking")
        self.assertEqual(answers[-1].stamp, self.frames[-1][2])
        T = answers[-1].T_world_camera
        numpy.testing.assert_allclose(T[:3, :3] @ T[:3, :3].T, numpy.eye(3), atol=1e-9)
        numpy.testing.assert_array_equal(T[3], [0, 0, 0, 1])
        covariance = answers[-1].covariance
        numpy.testing.assert_allclose(covariance, covariance.T, rtol=1e-9)
        self.assertTrue((numpy.linalg.eigvalsh(covariance) > 0).all())
        black = numpy.zeros_like(self.frames[0][1])
        slam = posefusion.Slam(SMALL)
        lost = slam.process(self.frames[0][0], black, 1.0, self.frames[0][3])
        self.assertIsNone(lost.T_world_camera)
        self.assertNotEqual(lost.reason, "")
        self.assertEqual((lost.stamp, len(slam.trajectory()), len(slam.map())), (1000000000, 0, 0))

    def test_errors_are_reported(self):
        slam = posefusion.Slam(SMALL)
        color, depth, stamp, camera = self.frames[0]
        for arguments, said in (((None, depth), "color is NoneType, expected a numpy array"),
                                ((color[..., 0], depth), r"color has the shape \(\d+, \d+\), expected \(height"),
                                ((color[:0], depth), "color has the shape"),
                                ((color.astype(float), depth), "color is of float64, expected uint8"),
                                ((color, depth.astype(">u2")), "depth is of >u2, expected uint16, or float32"),
                                ((color, depth.astype(numpy.int32)), "depth is of int32"),
                                ((color, depth[..., None]), "depth has the shape"),
                                ((color, depth[:-1]), "colour is .* but depth is"),
                                ((color, list(depth)), "depth is list")):
            with self.assertRaisesRegex(ValueError, said):
                slam.process(*arguments, stamp, camera)
        for wrong in ("1.0", None, float("nan"), 10 ** 30, True, 1 + 2j):
            with self.assertRaisesRegex(ValueError, "stamp is"):
                slam.process(color, depth, wrong, camera)
        with self.assertRaises(TypeError):
            slam.process(color, depth, stamp, {"fx": 1})
        other = posefusion.Camera(100, 80, 90, 90, 50, 40)
        with self.assertRaisesRegex(ValueError, "but the camera is 100x80"):
            slam.process(color, depth, stamp, other)
        self.assertEqual(slam.process(color, depth, stamp, camera).outcome, "fused", "nothing is broken")

    def test_settings_that_are_wrong_are_named(self):
        for config, mode, said in (({"frame": {"max_dept_m": 4}}, None, "max_dept_m"),
                                   ({"frame.max_depth_m": -4.0}, None, "max_depth_m"),
                                   ({"frame.max_depth_m": [1]}, None, "frame.max_depth_m is .1., expected a number"),
                                   ({3: 4}, None, "key 3 is no text"), ({}, "fast", "mode is 'fast'"),
                                   ("nowhere.yaml", None, "nowhere.yaml"), (3.5, None, "config is float")):
            with self.assertRaisesRegex(ValueError, said):
                posefusion.Slam(config, mode)
        file = pathlib.Path(self.folder.name, "settings.yaml")
        file.write_text("frame: {max_depth_m: 3}\n")
        posefusion.Slam(file, "pfh")
        with self.assertRaisesRegex(ValueError, "is no folder"):
            posefusion.open_folder("nowhere")
        with self.assertRaisesRegex(ValueError, "fx"):
            posefusion.Camera(100, 80, -1, 90, 50, 40)

    def test_python_goes_on_while_frames_are_processed(self):
        slam, ticks, end = posefusion.Slam(SMALL), [], threading.Event()

        def tick():
            while not end.is_set():
                ticks.append(time.perf_counter())
                time.sleep(0.0005)

        thread = threading.Thread(target=tick)
        thread.start()
        within = 0
        for color, depth, stamp, camera in self.frames:
            start = time.perf_counter()
            slam.process(color, depth, stamp, camera)
            length = time.perf_counter() - start
            within += any(start + 0.3 * length < t < start + 0.7 * length for t in ticks)
        end.set()
        thread.join()
        self.assertGreater(within, FRAMES // 2)

    def test_threads_wait_for_each_other(self):
        slam, answers = posefusion.Slam(SMALL), []

        def look():
            for _ in range(30):
                answers.append((len(slam.map()), len(slam.trajectory())))

        threads = [threading.Thread(target=look) for _ in range(2)]
        for thread in threads:
            thread.start()
        for color, depth, stamp, camera in self.frames:
            slam.process(color, depth, stamp, camera)
        for thread in threads:
            thread.join()
        self.assertEqual(len(answers), 60)

    def test_memory_does_not_grow(self):
        slam = self.mapped()[0]
        color, depth, stamp, camera = self.frames[-1]

        def use(times):
            for _ in range(times):
                slam.map()
                slam.trajectory()
                slam.process(color.copy(), depth.astype(numpy.float32), 5, camera)  # too late: refused
                next(iter(posefusion.open_folder(self.sequence))).color.sum()
                posefusion.evaluate.ate(slam.trajectory(), slam.trajectory())
            return memory_mb()

        before = use(30)
        self.assertLess(use(120) - before, 10, "MB; a leaked map or frame is 0.3 MB each time or more")

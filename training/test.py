#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""Tests of the training; they need what training needs. See README.md."""
import argparse
import pathlib
import tempfile
import unittest

import numpy as np
import torch

from exported import load_exported
from network import PersonNetwork
from report import opencv_answers, validation_rooms
from samples import mirrored, network_input, targets, tensors
from train import Schedule, Training, export, torch_answers

ROOT = pathlib.Path(__file__).resolve().parent.parent
MODEL = ROOT / "models" / "person.onnx"
GENERATOR = ROOT / "devel" / "lib" / "posefusion" / "posefusion_person_data"


def started():
    """Training continued from the model of the package."""
    training = Training(argparse.Namespace(seed=1, rate=1e-3, device="cpu"))
    load_exported(training.network, MODEL, network_input(SAMPLES["depth"]))
    return training


class Exported(unittest.TestCase):
    def test_the_network_answers_as_the_model_that_it_goes_on_from(self):
        inputs = network_input(SAMPLES["depth"])[:16]
        theirs = opencv_answers(str(MODEL))[0](inputs)
        for ours, expected in zip(torch_answers(started().network)(inputs), theirs):
            np.testing.assert_allclose(ours, expected, atol=1e-3)

    def test_an_export_is_taken_up_again(self):
        inputs = network_input(SAMPLES["depth"])[:16]
        other = started().network
        with torch.no_grad():
            for one in other.parameters():
                one.mul_(1 + 0.1 * torch.rand_like(one))
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "person.onnx"
            export(other, path)
            again = PersonNetwork()
            load_exported(again, path, network_input(SAMPLES["depth"]))
        for ours, expected in zip(torch_answers(again)(inputs), torch_answers(other)(inputs)):
            np.testing.assert_allclose(ours, expected, atol=1e-3)

    def test_a_model_of_another_shape_is_refused(self):
        smaller = PersonNetwork()
        smaller.eighth = smaller.eighth[:1]
        with self.assertRaisesRegex(RuntimeError, "person.onnx: its convolutions are not those"):
            load_exported(smaller, MODEL, network_input(SAMPLES["depth"]))


class Steps(unittest.TestCase):
    def test_the_rate_rises_and_falls_with_images_or_time(self):
        o = argparse.Namespace(rate=1.0, batch=32, images=100000, minutes=1e9)
        by_images = [Schedule(o).rate(images) for images in (0, 20000, 60000, 100000)]
        self.assertLess(by_images[0], 0.001)
        self.assertEqual(sorted(by_images[1:], reverse=True), by_images[1:])
        late = Schedule(argparse.Namespace(rate=1.0, batch=32, images=100000, minutes=1.0))
        late.start -= 59
        self.assertLess(late.rate(20000), 0.1)
        late.start -= 2
        self.assertEqual(late.part(20000), 1.0)

    def test_a_few_steps_lower_every_loss(self):
        training = Training(argparse.Namespace(seed=1, rate=1e-3, device="cpu"))
        batch = {name: field[:32] for name, field in SAMPLES.items()}
        first = training.step(batch, 1e-3)
        for _ in range(12):
            last = training.step(batch, 1e-3)
        for name, loss in first.items():
            self.assertLess(float(last[name]), float(loss), name)


class Samples(unittest.TestCase):
    def test_mirrored_pictures_have_mirrored_answers(self):
        one, other = targets(SAMPLES), targets(mirrored(SAMPLES))
        torch.testing.assert_close(one["mask"].flip(-1), other["mask"])
        self.assertGreater(float(one["joints"].sum()), 0)
        torch.testing.assert_close(one["joints"][:, 0].flip(-1), other["joints"][:, 0])

    def test_mirrored_twice_is_the_same(self):
        again = mirrored(mirrored(SAMPLES))
        for field in SAMPLES:
            np.testing.assert_allclose(again[field], SAMPLES[field], atol=1e-4)


if __name__ == "__main__":
    torch.set_num_threads(1)
    SAMPLES = tensors(validation_rooms(str(GENERATOR), 4))
    unittest.main()

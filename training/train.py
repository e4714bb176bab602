# SPDX-License-Identifier: BSD-3-Clause
"""Trains the person model on simulated pictures and exports it. See README.md."""
import argparse
import copy
import inspect
import json
import os
import pathlib
import time

import cv2
import numpy as np
import torch
from torch.nn import functional

from exported import load_exported
from network import Answers, PersonNetwork
from report import measure, opencv_answers, validation_rooms
from samples import ROOM, Pool, mirrored, network_input, targets

FIRST_ROOMS = 40  # taken in before the first step
WORST = 1e-3      # by which answers of the same weights may differ between programs


def options():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--folder", default="output/person", help="checkpoints and models")
    parser.add_argument("--generator", default="devel/lib/posefusion/posefusion_person_data")
    parser.add_argument("--images", type=int, default=1000000, help="train until so many are seen")
    parser.add_argument("--minutes", type=float, default=1e9,
                        help="ends after so long at the latest; the rate falls along the time, too")
    parser.add_argument("--device", default="cpu", help="cuda: a GPU, where there is one")
    parser.add_argument("--batch", type=int, default=32)
    parser.add_argument("--rate", type=float, default=2e-3, help="highest learning rate")
    parser.add_argument("--reuse", type=int, default=3, help="times a picture is seen, about")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--capacity", type=int, default=256, help="rooms kept, 6 MB each")
    parser.add_argument("--threads", type=int, default=1, help="of PyTorch")
    parser.add_argument("--generator-threads", type=int, default=1)
    parser.add_argument("--every", type=int, default=10000, help="images between reports")
    parser.add_argument("--validation-rooms", type=int, default=12)
    parser.add_argument("--start", type=pathlib.Path,
                        help="an exported model to go on from, where there is no checkpoint")
    return parser.parse_args()


def losses(answers, wanted):
    """Each about as large as the others."""
    mask, joints, centre = answers
    bce = functional.binary_cross_entropy_with_logits
    known = wanted["offset_weight"]
    miss = functional.smooth_l1_loss(centre[:, 1:], wanted["offset"], reduction="none", beta=0.2)
    joints_weight = wanted["joints_weight"] * (1 + 4 * wanted["joints"])
    return {
        "mask": 3 * bce(mask, wanted["mask"], wanted["mask_weight"]),
        "joints": 20 * bce(joints, wanted["joints"], joints_weight),
        "centre": 4 * bce(centre[:, :1], wanted["centre"], 1 + 4 * wanted["centre"]),
        "offset": 0.1 * (miss * known).sum() / (2 * known.sum() + 1),
    }


class Schedule:
    """How far the training is: by images or by time, whichever is further."""

    def __init__(self, o):
        self.o, self.start = o, time.time()

    def part(self, images):
        minutes = (time.time() - self.start) / 60
        return min(1.0, max(images / max(1, self.o.images), minutes / self.o.minutes))

    def rate(self, images):
        """Up over the first steps, then down along a cosine (Loshchilov and Hutter 2017)."""
        warm = min(1.0, (images + 1) / (160 * self.o.batch))
        return self.o.rate * warm * max(0.01, 0.5 + 0.5 * np.cos(np.pi * self.part(images)))


def in_memory(values):
    """A network or pictures, in the order that PyTorch is fastest with on a processor."""
    return values.to(memory_format=torch.channels_last)


class Training:
    """Network, its smoothed copy, optimiser and how far they are."""

    def __init__(self, o):
        torch.manual_seed(o.seed)
        self.device = torch.device(o.device)
        self.network = in_memory(PersonNetwork().to(self.device))
        self.smooth = copy.deepcopy(self.network)
        self.optimiser = torch.optim.AdamW(self.network.parameters(), o.rate, weight_decay=1e-2)
        self.images = self.rooms = 0

    def state(self):
        return {"network": self.network.state_dict(), "smooth": self.smooth.state_dict(),
                "optimiser": self.optimiser.state_dict(), "images": self.images,
                "rooms": self.rooms}

    def load(self, state):
        self.network.load_state_dict(state["network"])
        self.smooth.load_state_dict(state["smooth"])
        self.optimiser.load_state_dict(state["optimiser"])
        self.images, self.rooms = state["images"], state["rooms"]

    def losses(self, samples):
        """Of the network in training, by name."""
        self.network.train()
        return losses(self.network(in_memory(network_input(samples["depth"]))), targets(samples))

    def step(self, samples, rate):
        for group in self.optimiser.param_groups:
            group["lr"] = rate
        parts = self.losses(samples)
        self.optimiser.zero_grad(set_to_none=True)
        sum(parts.values()).backward()
        torch.nn.utils.clip_grad_norm_(self.network.parameters(), 5.0)
        self.optimiser.step()
        self.images += len(samples["depth"])
        self.follow()
        return {name: part.detach() for name, part in parts.items()}

    def follow(self):
        """The smoothed copy: a mean over the last thousands of images, less of the first ones."""
        part = max(0.002, 50 / (50 + self.images / 10))
        mine, theirs = ([value for value in network.state_dict().values()
                         if value.is_floating_point()] for network in (self.smooth, self.network))
        with torch.no_grad():
            torch._foreach_mul_(mine, 1 - part)
            torch._foreach_add_(mine, theirs, alpha=part)


def replace(path, write):
    temporary = path.with_name(path.name + ".part")
    write(str(temporary))
    os.replace(temporary, path)


def export(network, path):
    """ONNX of the probabilities; checks that OpenCV computes the same."""
    answers = Answers(copy.deepcopy(network)).to("cpu", memory_format=torch.contiguous_format)
    answers.eval()  # the wrapper too: else the export is of a network in training
    inputs = torch.rand(1, 3, 120, 160)
    names = ["mask", "joints", "centre"]
    # Newer PyTorch has another exporter, whose files OpenCV 4.6 does not read.
    known = inspect.signature(torch.onnx.export).parameters
    older = {"dynamo": False} if "dynamo" in known else {}
    replace(path, lambda name: torch.onnx.export(
        answers, inputs, name, input_names=["depth"], output_names=names, opset_version=11,
        **older))
    opencv = cv2.dnn.readNetFromONNX(str(path))
    opencv.setInput(inputs.numpy())
    with torch.no_grad():
        ours = answers(inputs)
    worst = max(float(np.abs(a.numpy() - b).max()) for a, b in zip(ours, opencv.forward(names)))
    if worst > WORST:
        raise RuntimeError(f"{path}: OpenCV's answers differ by {worst}, expected at most {WORST}")
    return worst


def torch_answers(network):
    """Mask and joints, as report.py asks for them."""
    network.eval()
    device = next(network.parameters()).device

    def answers(inputs):
        with torch.no_grad():
            mask, joints, _ = network(in_memory(inputs.to(device)))
        return torch.sigmoid(mask).cpu().numpy(), torch.sigmoid(joints).cpu().numpy()
    return answers


def start_from(training, model, samples):
    """Both networks answer as the exported model does."""
    inputs = network_input(samples["depth"])
    load_exported(training.network, model, inputs)
    training.smooth.load_state_dict(training.network.state_dict())
    pairs = zip(torch_answers(training.smooth)(inputs[:64]),
                opencv_answers(str(model))[0](inputs[:64].cpu()))
    worst = max(float(np.abs(ours - theirs).max()) for ours, theirs in pairs)
    if worst > WORST:
        raise RuntimeError(f"{model}: answers differ by {worst} after taking up its weights, "
                           f"expected at most {WORST}")
    print(f"goes on from {model}", flush=True)


def report(training, validation, folder):
    summary = measure(torch_answers(training.smooth), validation)
    summary["images"] = training.images
    replace(folder / "checkpoint.pt", lambda name: torch.save(training.state(), name))
    summary["differs from OpenCV by"] = export(training.smooth, folder / "person.onnx")
    with open(folder / "reports.jsonl", "a", encoding="utf-8") as file:
        file.write(json.dumps(summary) + "\n")
    print(json.dumps(summary), flush=True)


class Progress:
    """Means of the losses since the last line, and images per second."""

    def __init__(self, images):
        self.sums, self.images, self.start = {}, images, time.time()
        self.steps = 0

    def add(self, parts):
        self.sums = {name: self.sums.get(name, 0) + part for name, part in parts.items()}
        self.steps += 1

    def show(self, images):
        speed = (images - self.images) / (time.time() - self.start)
        text = " ".join(f"{name} {float(value) / self.steps:.4f}"
                        for name, value in self.sums.items())
        print(f"{images} images, {speed:.0f}/s: {text}", flush=True)


def train(training, pool, first, validation, o):
    dice = np.random.default_rng([o.seed, training.images])
    if o.start and training.images == 0:
        pool.take(FIRST_ROOMS)
        start_from(training, o.start, pool.draw(512, dice))
    schedule, progress = Schedule(o), Progress(training.images)
    while schedule.part(training.images) < 1.0:
        training.rooms = FIRST_ROOMS + training.images // (o.reuse * ROOM)
        pool.take(training.rooms - first)
        samples = pool.draw(o.batch, dice)
        if dice.random() < 0.5:
            samples = mirrored(samples)
        progress.add(training.step(samples, schedule.rate(training.images)))
        passed = [training.images // every != (training.images - o.batch) // every
                  for every in (50 * o.batch, o.every)]
        if passed[0]:
            progress.show(training.images)
            progress = Progress(training.images)
        if passed[1]:
            report(training, validation, pathlib.Path(o.folder))


def main():
    o = options()
    torch.set_num_threads(o.threads)
    torch.backends.cudnn.benchmark = True
    torch.backends.cudnn.allow_tf32 = False  # ten bits: answers would differ from OpenCV's by 0.03
    folder = pathlib.Path(o.folder)
    folder.mkdir(parents=True, exist_ok=True)
    training = Training(o)
    if (folder / "checkpoint.pt").exists():
        training.load(torch.load(folder / "checkpoint.pt", map_location=o.device))
        print(f"goes on after {training.images} images", flush=True)
    validation = validation_rooms(o.generator, o.validation_rooms)
    # After a break the pool is filled with rooms that it had.
    first = max(0, training.rooms - FIRST_ROOMS)
    generator = (o.generator, o.seed, o.generator_threads)
    pool = Pool(generator, first, o.capacity, o.device)
    try:
        train(training, pool, first, validation, o)
    finally:
        pool.close()
    report(training, validation, folder)


if __name__ == "__main__":
    main()

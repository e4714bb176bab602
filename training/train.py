# SPDX-License-Identifier: BSD-3-Clause
"""Trains the person model on simulated pictures and exports it. See README.md."""
import argparse
import copy
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
CAPACITY = 256    # rooms in memory, 1.5 GB
WORST = 1e-3      # by which answers of the same weights may differ between programs


def options():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--folder", default="output/person", help="checkpoints and models")
    parser.add_argument("--generator", default="devel/lib/posefusion/posefusion_person_data")
    parser.add_argument("--images", type=int, default=1000000, help="train until so many are seen")
    parser.add_argument("--batch", type=int, default=32)
    parser.add_argument("--rate", type=float, default=2e-3, help="highest learning rate")
    parser.add_argument("--reuse", type=int, default=3, help="times a picture is seen, about")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--threads", type=int, default=1, help="of PyTorch")
    parser.add_argument("--bfloat16", action="store_true",
                        help="1.6 times as fast where the processor has it (avx512_bf16, amx)")
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


def rate_at(image, o):
    """Up over the first images, then down along a cosine (Loshchilov and Hutter 2017)."""
    part = image / o.images
    return o.rate * min(1, (image + 1) / 5000) * max(0.01, 0.5 + 0.5 * np.cos(np.pi * part))


class Training:
    """Network, its smoothed copy, optimiser and how far they are."""

    def __init__(self, o):
        torch.manual_seed(o.seed)
        self.network = PersonNetwork().to(memory_format=torch.channels_last)
        self.smooth = copy.deepcopy(self.network)
        self.bfloat16 = o.bfloat16
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

    def losses(self, samples, bfloat16):
        """Of the network in training, by name."""
        inputs = network_input(samples["depth"]).contiguous(memory_format=torch.channels_last)
        self.network.train()
        with torch.autocast("cpu", dtype=torch.bfloat16, enabled=bfloat16):
            features = self.network.features(inputs)
        # Not the heads: in bfloat16, PyTorch 1.13 computes a wrong gradient through a convolution
        # to one channel, and nothing before the mask's learns from it.
        answers = self.network.heads(*(feature.float() for feature in features))
        return losses(answers, targets(samples))

    def step(self, samples, rate):
        for group in self.optimiser.param_groups:
            group["lr"] = rate
        parts = self.losses(samples, self.bfloat16)
        self.optimiser.zero_grad(set_to_none=True)
        sum(parts.values()).backward()
        torch.nn.utils.clip_grad_norm_(self.network.parameters(), 5.0)
        self.optimiser.step()
        self.images += len(samples)
        self.follow()
        return {name: float(part) for name, part in parts.items()}

    def follow(self):
        """The smoothed copy: a mean over the last thousands of images, less of the first ones."""
        part = max(0.002, 50 / (50 + self.images / 10))
        with torch.no_grad():
            theirs = self.network.state_dict()
            for name, mine in self.smooth.state_dict().items():
                if mine.is_floating_point():
                    mine.lerp_(theirs[name], part)
                else:
                    mine.copy_(theirs[name])


def replace(path, write):
    temporary = path.with_name(path.name + ".part")
    write(str(temporary))
    os.replace(temporary, path)


def export(network, path):
    """ONNX of the probabilities; checks that OpenCV computes the same."""
    answers = Answers(copy.deepcopy(network)).to(memory_format=torch.contiguous_format)
    answers.eval()  # the wrapper too: else the export is of a network in training
    inputs = torch.rand(1, 3, 120, 160)
    names = ["mask", "joints", "centre"]
    replace(path, lambda name: torch.onnx.export(answers, inputs, name, input_names=["depth"],
                                                 output_names=names, opset_version=11))
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

    def answers(inputs):
        with torch.no_grad():
            mask, joints, _ = network(inputs.contiguous(memory_format=torch.channels_last))
        return torch.sigmoid(mask).numpy(), torch.sigmoid(joints).numpy()
    return answers


def start_from(training, model, samples):
    """Both networks answer as the exported model does."""
    inputs = network_input(samples["depth"])
    load_exported(training.network, model, inputs)
    training.smooth.load_state_dict(training.network.state_dict())
    pairs = zip(torch_answers(training.smooth)(inputs[:64]),
                opencv_answers(str(model))[0](inputs[:64]))
    worst = max(float(np.abs(ours - theirs).max()) for ours, theirs in pairs)
    if worst > WORST:
        raise RuntimeError(f"{model}: answers differ by {worst} after taking up its weights, "
                           f"expected at most {WORST}")
    print(f"goes on from {model}", flush=True)


def report(training, validation, folder):
    summary = measure(torch_answers(training.smooth), validation)
    summary["images"] = training.images
    summary["differs from OpenCV by"] = export(training.smooth, folder / "person.onnx")
    replace(folder / "checkpoint.pt", lambda name: torch.save(training.state(), name))
    with open(folder / "reports.jsonl", "a", encoding="utf-8") as file:
        file.write(json.dumps(summary) + "\n")
    print(json.dumps(summary), flush=True)


def main():
    o = options()
    torch.set_num_threads(o.threads)
    folder = pathlib.Path(o.folder)
    folder.mkdir(parents=True, exist_ok=True)
    training = Training(o)
    if (folder / "checkpoint.pt").exists():
        training.load(torch.load(folder / "checkpoint.pt"))
        print(f"goes on after {training.images} images", flush=True)
    validation = validation_rooms(o.generator, o.validation_rooms)
    # After a break the pool is filled with rooms that it had.
    first = max(0, training.rooms - FIRST_ROOMS)
    pool = Pool(o.generator, o.seed, first, CAPACITY)
    dice = np.random.default_rng([o.seed, training.images])
    if o.start and training.images == 0:
        pool.take(FIRST_ROOMS)
        start_from(training, o.start, pool.draw(512, dice))
    sums, steps, start = {}, 0, time.time()
    while training.images < o.images:
        training.rooms = FIRST_ROOMS + training.images // (o.reuse * ROOM)
        pool.take(training.rooms - first)
        samples = pool.draw(o.batch, dice)
        if dice.random() < 0.5:
            samples = mirrored(samples)
        parts = training.step(samples, rate_at(training.images, o))
        sums = {name: sums.get(name, 0) + part for name, part in parts.items()}
        steps += 1
        if training.images // 1600 != (training.images - o.batch) // 1600:
            speed = steps * o.batch / (time.time() - start)
            text = " ".join(f"{name} {value / steps:.4f}" for name, value in sums.items())
            print(f"{training.images} images, {speed:.0f}/s: {text}", flush=True)
            sums, steps, start = {}, 0, time.time()
        if training.images // o.every != (training.images - o.batch) // o.every:
            report(training, validation, folder)
    report(training, validation, folder)
    pool.close()


if __name__ == "__main__":
    main()

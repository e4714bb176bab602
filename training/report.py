# SPDX-License-Identifier: BSD-3-Clause
"""Measures a person model on simulated rooms that training never saw."""
import argparse
import pathlib
import time

import cv2
import numpy as np
import torch

from samples import FARTHEST_M, NEAREST_M, SAMPLE, generate, network_input, read_room, tensors

VALIDATION_SEED = 990001  # training uses smaller ones
MASK_LEVEL, JOINT_LEVEL = 0.5, 0.3
REACH = 2.0  # cells of 4x4 pixels between a joint and its peak


def validation_rooms(program, rooms):
    process = generate(program, VALIDATION_SEED, 0, rooms, 0)
    samples = np.concatenate([read_room(process) for _ in range(rooms)])
    process.wait()
    return samples.view(SAMPLE)


def in_view(joints):
    """Head and torso: a face's joint or ear, the neck, a hip."""
    state = joints[:, 2] > 0
    return state[[0, 14, 15, 16, 17]].any() and state[1] and (state[8] or state[11])


def joints_found(joints, maps):
    """Joints in view with a value of JOINT_LEVEL near them: found, asked."""
    found = asked = 0
    for joint, (x, y, state) in enumerate(joints):
        if state != 2:
            continue
        asked += 1
        cx, cy = (x + 0.5) / 4 - 0.5, (y + 0.5) / 4 - 0.5
        x0, y0 = max(0, round(cx - REACH)), max(0, round(cy - REACH))
        window = maps[joint, y0:round(cy + REACH) + 1, x0:round(cx + REACH) + 1]
        found += window.size > 0 and window.max() > JOINT_LEVEL
    return found, asked


def mean(values):
    return float(np.mean(values)) if values else 0.0


class Report:
    """Sums over pictures."""

    def __init__(self):
        self.iou, self.precision, self.recall = [], [], []
        self.empty = self.false = 0
        self.people = self.found = 0
        self.joints = np.zeros(2, int)
        self.near_joints = np.zeros(2, int)

    def add_mask(self, known, truth, mask):
        """Truth (bool) where there is depth; the answer, true for people."""
        truth = truth & known
        answer = cv2.resize(mask, known.shape[::-1], interpolation=cv2.INTER_LINEAR) > MASK_LEVEL
        answer &= known
        both = np.count_nonzero(answer & truth)
        if not truth.any():
            self.empty += 1
            self.false += answer.mean() > 0.01
        elif truth.mean() > 0.02:
            self.iou.append(both / np.count_nonzero(answer | truth))
            self.recall.append(both / np.count_nonzero(truth))
            if answer.any():
                self.precision.append(both / np.count_nonzero(answer))
        return answer

    def add(self, sample, mask, joints):
        depth = sample["depth"]
        known = depth > 0
        answer = self.add_mask(known, sample["person"] > 0, mask)
        for person in range(len(sample["centre"])):
            body = (sample["person"] == person + 1) & known
            if not body.any():
                continue
            counts = np.array(joints_found(sample["joints"][person], joints))
            self.joints += counts
            distance = np.median(depth[body]) / 1000
            if 1 <= distance <= 4 and in_view(sample["joints"][person]):
                self.people += 1
                self.near_joints += counts
                covered = np.count_nonzero(answer & body) >= 0.5 * np.count_nonzero(body)
                self.found += covered and counts[0] >= 4

    def summary(self):
        return {
            "frames with people over 2 %": len(self.iou),
            "mean IoU": mean(self.iou),
            "mean recall": mean(self.recall),
            "mean precision": mean(self.precision),
            "empty frames": self.empty,
            "of them masked over 1 %": self.false / max(1, self.empty),
            "people 1-4 m, head and torso in view": self.people,
            "of them found (half the body, 4 joints)": self.found / max(1, self.people),
            "their joints found": self.near_joints[0] / max(1, self.near_joints[1]),
            "all joints found": self.joints[0] / max(1, self.joints[1]),
        }


def measure(answers, samples):
    """`answers` gives mask, joints (numpy, B x ...) of a network input."""
    report = Report()
    for first in range(0, len(samples), 32):
        batch = samples[first:first + 32]
        mask, joints = answers(network_input(tensors(batch)["depth"]))
        for i, sample in enumerate(batch):
            report.add(sample, mask[i, 0], joints[i])
    return report.summary()


def opencv_answers(model):
    network = cv2.dnn.readNetFromONNX(model)
    spent = []

    def answer(inputs):
        masks, joints = [], []
        for one in inputs.numpy():
            network.setInput(one[None])
            start = time.perf_counter()
            out = network.forward(["mask", "joints", "centre"])
            spent.append(time.perf_counter() - start)
            masks.append(out[0][0])
            joints.append(out[1][0])
        return np.stack(masks), np.stack(joints)
    return answer, spent


def shrunk(depth_m):
    """Depth at 160x120 of 640x480: shrinkDepth of the package."""
    cells = depth_m.reshape(120, 4, 160, 4).transpose(0, 2, 1, 3).reshape(120, 160, 16).copy()
    valid = (cells > NEAREST_M) & (cells < FARTHEST_M)
    cells[~valid] = np.inf
    cells.sort(-1)
    count = valid.sum(-1)
    middle = np.maximum((count - 1) // 2, 0)[..., None]
    return np.where(count < 2, 0, np.take_along_axis(cells, middle, -1)[..., 0])


def measure_recording(answers, folder, every):
    """A simulated recording of 640x480 (posefusion_simulate, TUM folder), each so many frames."""
    lines = (folder / "camera.yaml").read_text(encoding="utf-8").splitlines()
    factor = float(dict(line.split(": ", 1) for line in lines if ": " in line)["depth_factor"])
    report = Report()
    depths, masks = (sorted((folder / name).glob("*.png")) for name in ("depth", "mask"))
    for depth_file, mask_file in list(zip(depths, masks, strict=True))[::every]:
        depth = cv2.imread(str(depth_file), cv2.IMREAD_UNCHANGED).astype(np.float32) / factor
        truth = cv2.imread(str(mask_file), cv2.IMREAD_GRAYSCALE) > 0
        mask, _ = answers(network_input(torch.from_numpy(1000 * shrunk(depth)[None])))
        report.add_mask(depth > 0, truth, mask[0, 0])
    names = list(report.summary())[:6]
    return {name: report.summary()[name] for name in names}


def show(summary):
    for name, value in summary.items():
        print(f"{name}: {value:.3f}" if isinstance(value, float) else f"{name}: {value}")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("model", help="ONNX file")
    parser.add_argument("--generator", default="devel/lib/posefusion/posefusion_person_data")
    parser.add_argument("--rooms", type=int, default=24, help="96 pictures of each")
    parser.add_argument("--recordings", type=pathlib.Path, nargs="*", default=[],
                        help="simulated TUM folders of 640x480 instead of rooms")
    parser.add_argument("--every", type=int, default=45, help="each so many frames of them")
    options = parser.parse_args()
    answers, spent = opencv_answers(options.model)
    for folder in options.recordings:
        print(folder.name)
        show(measure_recording(answers, folder, options.every))
    if not options.recordings:
        show(measure(answers, validation_rooms(options.generator, options.rooms)))
    print(f"OpenCV, {cv2.getNumThreads()} threads: median {1e3 * np.median(spent):.1f} ms")


if __name__ == "__main__":
    main()

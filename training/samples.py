# SPDX-License-Identifier: BSD-3-Clause
"""Training pictures from posefusion_person_data, and the answers that the network learns."""
import queue
import subprocess
import threading

import numpy as np
import torch

PEOPLE = 6
ROOM = 96  # pictures of a room
SAMPLE = np.dtype([("depth", "<u2", (120, 160)), ("person", "u1", (120, 160)),
                   ("joints", "<f4", (PEOPLE, 18, 3)), ("centre", "<f4", (PEOPLE, 3))])
# Joints after a picture is mirrored.
MIRRORED = [0, 1, 5, 6, 7, 2, 3, 4, 11, 12, 13, 8, 9, 10, 15, 14, 17, 16]
NEAREST_M, FARTHEST_M = 0.25, 8.0
JOINT_SIGMA, CENTRE_SIGMA = 0.9, 1.3  # cells of 4x4 pixels
LEAST_PIXELS = 30  # of a person whose centre is learned


def generate(program, seed, first_room, rooms, threads=1):
    """A process that writes the samples of `rooms` rooms to its stdout."""
    return subprocess.Popen(
        [program, "--seed", str(seed), "--first-room", str(first_room), "--rooms", str(rooms),
         "--threads", str(threads)], stdout=subprocess.PIPE)


def read_room(process):
    size = ROOM * SAMPLE.itemsize
    data = process.stdout.read(size)
    if len(data) != size:
        raise RuntimeError(f"posefusion_person_data: ended after {len(data)} of {size} bytes")
    return np.frombuffer(data, SAMPLE)


class Pool:
    """The latest rooms. Batches are drawn from all of them; what is drawn depends on the numbers
    of rooms taken in and of batches drawn, not on time."""

    def __init__(self, program, seed, first_room, capacity):
        self.rooms = np.zeros((capacity, ROOM), SAMPLE)
        self.taken = 0
        self.process = generate(program, seed, first_room, 1 << 24)
        self.ahead = queue.Queue(4)
        threading.Thread(target=self._read, daemon=True).start()

    def _read(self):
        try:
            while True:
                self.ahead.put(read_room(self.process))
        except RuntimeError as error:
            self.ahead.put(error)

    def take(self, rooms):
        """Takes rooms in until so many have been."""
        while self.taken < rooms:
            room = self.ahead.get()
            if isinstance(room, Exception):
                raise room
            self.rooms[self.taken % len(self.rooms)] = room
            self.taken += 1

    def draw(self, size, dice):
        filled = min(self.taken, len(self.rooms)) * ROOM
        return self.rooms.reshape(-1)[dice.integers(0, filled, size)]

    def close(self):
        self.process.kill()


def network_input(depth_mm):
    """Bx3x120x160 of depth in millimetres, as depth_input.hpp makes it."""
    depth = torch.from_numpy(depth_mm.astype(np.float32)) / 1000
    valid = (depth > NEAREST_M) & (depth < FARTHEST_M)
    safe = torch.where(valid, depth, torch.ones(()))
    return torch.stack((valid / safe, torch.log(safe), valid.float()), 1)


def mirrored(samples):
    samples = samples.copy()
    samples["depth"] = samples["depth"][:, :, ::-1]
    samples["person"] = samples["person"][:, :, ::-1]
    samples["joints"] = samples["joints"][:, :, MIRRORED]
    samples["joints"][..., 0] = 159 - samples["joints"][..., 0]
    samples["centre"][..., 0] = 159 - samples["centre"][..., 0]
    return samples


def bells(places, present, sigma):
    """Bell curves at places (B, people, maps, 2; pixels): the largest of all people, B x maps x 30
    x 40."""
    cell = (places + 0.5) / 4 - 0.5
    x = torch.exp(-(torch.arange(40) - cell[..., 0:1]) ** 2 / (2 * sigma ** 2))
    y = torch.exp(-(torch.arange(30) - cell[..., 1:2]) ** 2 / (2 * sigma ** 2))
    return ((y * present[..., None])[..., None] * x[..., None, :]).amax(1)


def targets(samples):
    """The answers that the network learns, and their weights."""
    person = torch.from_numpy((samples["person"] > 0).astype(np.float32))
    seen = torch.from_numpy((samples["depth"] > 0).astype(np.float32))
    pooled = torch.nn.functional.avg_pool2d
    joints = torch.from_numpy(samples["joints"].copy())
    centre = torch.from_numpy(samples["centre"].copy())
    behind = bells(joints[..., :2], (joints[..., 2] == 1).float(), JOINT_SIGMA) > 0.1
    inside = ((centre[..., 0] > -4) & (centre[..., 0] < 164) & (centre[..., 1] > -4)
              & (centre[..., 1] < 124) & (centre[..., 2] >= LEAST_PIXELS))
    # Offsets where the middle of a cell shows a body.
    shown = torch.from_numpy(samples["person"][:, 2::4, 2::4].astype(np.int64))
    owner = (shown - 1).clamp(0, PEOPLE - 1).reshape(len(samples), -1, 1).expand(-1, -1, 3)
    goal = torch.gather(centre, 1, owner).reshape(len(samples), 30, 40, 3)
    place = torch.stack(torch.meshgrid(4 * torch.arange(40) + 1.5, 4 * torch.arange(30) + 1.5,
                                       indexing="xy"), -1)
    offset = ((goal[..., :2] - place) / 10).clamp(-15, 15)
    known = (shown > 0) & (goal[..., 0] != -1)
    return {
        "mask": pooled(person[:, None], 2),
        # Where there is no depth the answer hardly matters.
        "mask_weight": 0.1 + 0.9 * (pooled(seen[:, None], 2) > 0),
        "joints": bells(joints[..., :2], (joints[..., 2] == 2).float(), JOINT_SIGMA),
        "joints_weight": (~behind).float(),
        "centre": bells(centre[:, :, None, :2], inside.float()[..., None], CENTRE_SIGMA),
        "offset": offset.permute(0, 3, 1, 2),
        "offset_weight": known[:, None].float(),
    }

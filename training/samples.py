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


def generate(program, seed, first_room, rooms, threads):
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


def tensors(samples, device="cpu"):
    """The fields of samples, each a tensor; depth as 16 bits with a sign, which 32 m fit in."""
    fields = {"depth": samples["depth"].astype(np.int16), "person": samples["person"],
              "joints": samples["joints"], "centre": samples["centre"]}
    return {name: torch.from_numpy(np.ascontiguousarray(field)).to(device)
            for name, field in fields.items()}


class Pool:
    """The latest rooms, where the network is. Batches are drawn from all of them; what is drawn
    depends on the numbers of rooms taken in and of batches drawn, not on time."""

    def __init__(self, generator, first_room, capacity, device="cpu"):
        """`generator`: program, seed, threads."""
        program, seed, threads = generator
        blank = tensors(np.zeros(1, SAMPLE), device)
        self.samples = {name: field.repeat(capacity * ROOM, *[1] * (field.dim() - 1))
                        for name, field in blank.items()}
        self.capacity, self.device = capacity, device
        self.taken = 0
        self.process = generate(program, seed, first_room, 1 << 24, threads)
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
            start = self.taken % self.capacity * ROOM
            for name, field in tensors(room, self.device).items():
                self.samples[name][start:start + ROOM] = field
            self.taken += 1

    def draw(self, size, dice):
        filled = min(self.taken, self.capacity) * ROOM
        which = torch.from_numpy(dice.integers(0, filled, size)).to(self.device)
        return {name: field[which] for name, field in self.samples.items()}

    def close(self):
        self.process.kill()


def network_input(depth_mm):
    """Bx3x120x160 of depth in millimetres (a tensor), as depth_input.hpp makes it."""
    depth = depth_mm.float() / 1000
    valid = (depth > NEAREST_M) & (depth < FARTHEST_M)
    safe = torch.where(valid, depth, torch.ones_like(depth))
    return torch.stack((valid / safe, torch.log(safe), valid.float()), 1)


def mirrored(samples):
    joints, centre = samples["joints"][:, :, MIRRORED], samples["centre"].clone()
    joints[..., 0] = 159 - joints[..., 0]
    centre[..., 0] = 159 - centre[..., 0]
    return {"depth": samples["depth"].flip(-1), "person": samples["person"].flip(-1),
            "joints": joints, "centre": centre}


def bells(places, present, sigma):
    """Bell curves at places (B, people, maps, 2; pixels): the largest of all people, B x maps x 30
    x 40."""
    cell = (places + 0.5) / 4 - 0.5
    cols, rows = (torch.arange(count, device=cell.device) for count in (40, 30))
    x = torch.exp(-(cols - cell[..., 0:1]) ** 2 / (2 * sigma ** 2))
    y = torch.exp(-(rows - cell[..., 1:2]) ** 2 / (2 * sigma ** 2))
    return ((y * present[..., None])[..., None] * x[..., None, :]).amax(1)


def targets(samples):
    """The answers that the network learns, and their weights."""
    person, seen = ((samples[name] > 0).float() for name in ("person", "depth"))
    pooled = torch.nn.functional.avg_pool2d
    joints, centre = samples["joints"], samples["centre"]
    behind = bells(joints[..., :2], (joints[..., 2] == 1).float(), JOINT_SIGMA) > 0.1
    inside = ((centre[..., 0] > -4) & (centre[..., 0] < 164) & (centre[..., 1] > -4)
              & (centre[..., 1] < 124) & (centre[..., 2] >= LEAST_PIXELS))
    # Offsets where the middle of a cell shows a body.
    shown = samples["person"][:, 2::4, 2::4].long()
    owner = (shown - 1).clamp(0, PEOPLE - 1).reshape(len(shown), -1, 1).expand(-1, -1, 3)
    goal = torch.gather(centre, 1, owner).reshape(len(shown), 30, 40, 3)
    cols, rows = (4 * torch.arange(count, device=shown.device) + 1.5 for count in (40, 30))
    place = torch.stack(torch.meshgrid(cols, rows, indexing="xy"), -1)
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

# SPDX-License-Identifier: BSD-3-Clause
"""The person model: a small U-Net of depthwise separable convolutions."""
import torch
from torch import nn
from torch.nn import functional

JOINTS = 18


def convolution(inputs, outputs, size, stride=1, groups=1):
    return nn.Sequential(
        nn.Conv2d(inputs, outputs, size, stride, size // 2, groups=groups, bias=False),
        nn.BatchNorm2d(outputs))


class Block(nn.Module):
    """Depthwise and pointwise convolution (Howard et al. 2017), with a way past both where the
    shape stays the same."""

    def __init__(self, inputs, outputs, stride=1):
        super().__init__()
        self.depthwise = convolution(inputs, inputs, 3, stride, inputs)
        self.pointwise = convolution(inputs, outputs, 1)
        self.passes = stride == 1 and inputs == outputs

    def forward(self, x):
        y = self.pointwise(functional.relu(self.depthwise(x)))
        return functional.relu(x + y if self.passes else y)


def chain(inputs, outputs, count, stride=1):
    blocks = [Block(inputs, outputs, stride)]
    blocks += [Block(outputs, outputs) for _ in range(count - 1)]
    return nn.Sequential(*blocks)


class Up(nn.Module):
    """Twice the size, joined with what the encoder knew there (Ronneberger et al. 2015)."""

    def __init__(self, low, skip, outputs, count, rows):
        super().__init__()
        self.rows = rows
        self.low = convolution(low, outputs, 1)
        self.skip = convolution(skip, outputs, 1)
        self.blocks = chain(outputs, outputs, count)

    def forward(self, low, skip):
        large = functional.interpolate(self.low(low), scale_factor=2.0, mode="nearest")
        large = large[:, :, :self.rows]  # 8 rows came from 15
        return self.blocks(functional.relu(large + self.skip(skip)))


class PersonNetwork(nn.Module):
    """Input 1x3x120x160. Answers mask (1x60x80), joints (18x30x40) and centre (3x30x40: a
    probability, then offsets x, y in units of ten pixels of the input); logits where a probability
    is meant."""

    def __init__(self):
        super().__init__()
        self.stem = convolution(3, 16, 3, 2)
        self.second = chain(16, 24, 1)
        self.fourth = chain(24, 56, 2, stride=2)
        self.eighth = chain(56, 112, 3, stride=2)
        self.sixteenth = chain(112, 192, 5, stride=2)
        self.up_eighth = Up(192, 112, 112, 2, 15)
        self.up_fourth = Up(112, 56, 64, 2, 30)
        self.up_second = Up(64, 24, 24, 1, 60)
        self.mask = nn.Conv2d(24, 1, 1)
        self.points = chain(64, 64, 1)
        self.joints = nn.Conv2d(64, JOINTS, 1)
        self.centre = nn.Conv2d(64, 3, 1)
        for head in (self.mask, self.joints):
            nn.init.constant_(head.bias, -3.0)
        with torch.no_grad():
            self.centre.bias[0] = -3.0

    def forward(self, depth):
        return self.heads(*self.features(depth))

    def features(self, depth):
        """Bx24x60x80 for the mask, Bx64x30x40 for joints and centres."""
        half = self.second(functional.relu(self.stem(depth)))
        quarter = self.fourth(half)
        eighth = self.eighth(quarter)
        eighth = self.up_eighth(self.sixteenth(eighth), eighth)
        quarter = self.up_fourth(eighth, quarter)
        points = self.points(quarter)
        return self.up_second(quarter, half), points

    def heads(self, fine, points):
        return self.mask(fine), self.joints(points), self.centre(points)


class Answers(nn.Module):
    """What is exported: probabilities."""

    def __init__(self, network):
        super().__init__()
        self.network = network

    def forward(self, depth):
        mask, joints, centre = self.network(depth)
        centre = torch.cat((torch.sigmoid(centre[:, :1]), centre[:, 1:]), 1)
        return torch.sigmoid(mask), torch.sigmoid(joints), centre

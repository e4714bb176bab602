# SPDX-License-Identifier: BSD-3-Clause
"""Continues training from an exported model, when its checkpoint is gone."""
import math

import onnx
import torch
from onnx import numpy_helper
from torch import nn


def exported_convolutions(path):
    """Weights and biases of the model file's convolutions, in the order of their use."""
    graph = onnx.load(str(path)).graph
    values = {value.name: numpy_helper.to_array(value) for value in graph.initializer}
    found = []
    for node in graph.node:
        if node.op_type == "Conv":
            weight, bias = (torch.from_numpy(values[name].copy()) for name in node.input[1:3])
            found.append((weight, bias))
    return found


def used_convolutions(network, inputs):
    """The network's convolutions in the order of their use."""
    used = []
    hooks = [module.register_forward_hook(lambda one, *_: used.append(one))
             for module in network.modules() if isinstance(module, nn.Conv2d)]
    network(inputs)
    for hook in hooks:
        hook.remove()
    return used


def normalisations(network):
    """The batch normalisation behind each convolution that has one."""
    behind = {}
    for module in network.modules():
        if isinstance(module, nn.Sequential) and len(module) == 2:
            first, second = module
            if isinstance(first, nn.Conv2d) and isinstance(second, nn.BatchNorm2d):
                behind[first] = second
    return behind


def keep_answer(normalisation, scale, bias):
    """From the next pass on, the normalisation has the mean and variance of that pass's inputs,
    and turns them into `scale` * input + `bias`."""
    def fit(module, inputs, _):
        hook.remove()
        mean = inputs[0].mean((0, 2, 3))
        variance = inputs[0].var((0, 2, 3))
        module.running_mean.copy_(mean)
        module.running_var.copy_(variance)
        module.weight.copy_(scale * torch.sqrt(variance + module.eps))
        module.bias.copy_(bias + scale * mean)
        return scale * inputs[0] + bias[:, None, None]
    hook = normalisation.register_forward_hook(fit)


@torch.no_grad()
def load_exported(network, path, inputs):
    """Makes the network answer as the model file does. An export has no batch normalisation: it
    is folded into the weights. Here it is taken out of them again, with the means and variances
    that `inputs` (Bx3x120x160, some hundreds of training pictures) give; each layer's weights are
    brought to the size that they begin with, for the learning rate's sake."""
    network.eval()
    ours, theirs = used_convolutions(network, inputs[:1]), exported_convolutions(path)
    shapes = [[tuple(one.weight.shape) for one in ours],
              [tuple(weight.shape) for weight, _ in theirs]]
    if shapes[0] != shapes[1]:
        raise RuntimeError(f"{path}: its convolutions are not those of network.py: {shapes[1]}, "
                           f"expected {shapes[0]}")
    behind = normalisations(network)
    for convolution, parts in zip(ours, theirs):
        weight, bias = (part.to(convolution.weight.device) for part in parts)
        if convolution in behind:
            fresh = math.prod(weight.shape[1:]) ** -0.5 / math.sqrt(3)  # PyTorch's first weights
            scale = float(weight.std()) / fresh
            convolution.weight.copy_(weight / scale)
            keep_answer(behind[convolution], scale, bias)
        else:
            convolution.weight.copy_(weight)
            convolution.bias.copy_(bias)
    network(inputs)

# SPDX-FileCopyrightText: 2026 The semantic_vslam authors
# SPDX-License-Identifier: BSD-3-Clause
"""Reads the public DeepLab v3 on MobileNetV2 (deeplabv3_mnv2_pascal_quant.onnx, Apache-2.0), which has seen millions of photographs,
as weights to begin a training with: all of the semantic branch, and its classes as the first guess of ours."""
import numpy as np
import torch

from bisenetv2 import BiSeNetV2
from classes import NAMES

# VOC's, in their order, by what we call them; the others are background
VOC = ('background', '', '', '', '', 'bottle', '', '', '', 'chair', '', 'table', '', '', '', 'person', '', '', '', '', 'monitor')
UNKNOWN_CLASS = -4.0  # logit of ours that it does not know


def is_ready_network(graph):
    return any('MobilenetV2/' in weights.name for weights in graph.initializer)


def weights_of_ready_network(graph, path):
    """@return {name of BiSeNetV2's: tensor}. Ends the program if the graph, which `path` holds, is of another network."""
    from onnx import numpy_helper
    stored = {weights.name: weights for weights in graph.initializer}
    values = {}
    for node in graph.node:
        if node.op_type == 'DequantizeLinear' and set(node.input) <= stored.keys():
            whole, scale, zero = (numpy_helper.to_array(stored[name]).astype(np.float32) for name in node.input)
            values[node.output[0]] = torch.from_numpy((whole - zero) * scale)
    layers = [[values[name] for name in node.input[1:]] for node in graph.node if node.op_type == 'Conv']
    model = BiSeNetV2(len(NAMES))
    ours = [name for name, module in model.semantic.features.named_modules() if isinstance(module, torch.nn.Conv2d)]
    names = [f'semantic.features.{name}' for name in ours] + ['semantic.context.local.0', 'semantic.context.mean.0']
    if len(layers) != len(names) + 2:
        raise SystemExit(f"'{path}' has {len(layers)} convolutions, DeepLab v3 on MobileNetV2 has {len(names) + 2}")
    found = {f'{name}.{kind}': value for name, layer in zip(names, layers) for kind, value in zip(('weight', 'bias'), layer)}
    (joined, bias), (logits, offsets) = layers[-2:]
    of_mean, of_local = joined.split(joined.shape[1] // 2, dim=1)
    found.update({'semantic.context.of_local.weight': of_local, 'semantic.context.of_local.bias': bias,
                  'semantic.context.of_mean.weight': of_mean})
    rows = [VOC.index(name) if name in VOC else None for name in NAMES]
    found['coarse.weight'] = torch.stack([torch.zeros_like(logits[0]) if k is None else logits[k] for k in rows])
    found['coarse.bias'] = torch.stack([torch.tensor(UNKNOWN_CLASS) if k is None else offsets[k] for k in rows])
    wanted = model.state_dict()
    for name, value in found.items():
        if value.shape != wanted[name].shape:
            raise SystemExit(f"'{path}' is not DeepLab v3 on MobileNetV2: {name} is {list(value.shape)}, not {list(wanted[name].shape)}")
    return found

# SPDX-FileCopyrightText: 2026 The semantic_vslam authors
# SPDX-License-Identifier: BSD-3-Clause
"""Checkpoints, and the sidecar that tells the C++ side how to run an exported network."""
import os

import numpy as np
import torch

from bisenetv2 import DETAIL_CHANNELS, BiSeNetV2, TwoScales
from classes import CLASSES, NAMES
from ready_network import is_ready_network, weights_of_ready_network

MEAN = (0.5, 0.5, 0.5)  # red, green, blue in [0, 1], of the network that training begins with (ready_network.py)
STD = (0.5, 0.5, 0.5)
STRIDE = 8


def normalise(images):
    """@param images N x 3 x H x W, uint8 RGB  @return float32"""
    mean = torch.tensor(MEAN, device=images.device).view(1, 3, 1, 1)
    std = torch.tensor(STD, device=images.device).view(1, 3, 1, 1)
    return (images.float() / 255 - mean) / std


def save_checkpoint(path, **content):
    """Written whole or not at all."""
    torch.save(content, path + '.tmp')
    os.replace(path + '.tmp', path)


def load_checkpoint(path):
    if not os.path.exists(path):
        raise SystemExit(f"checkpoint '{path}' does not exist; train.py writes one")
    try:
        checkpoint = torch.load(path, map_location='cpu')
    except Exception as error:  # pickle's, PyTorch's own, or of whatever the file's bytes happen to say
        raise SystemExit(f"'{path}' is no checkpoint: {(str(error) or type(error).__name__).splitlines()[0]}; train.py writes one") from None
    if not isinstance(checkpoint, dict) or 'average' not in checkpoint:
        raise SystemExit(f"'{path}' is a file of PyTorch, but no checkpoint; train.py writes one")
    return checkpoint


def widths(weights, path):
    """@return {argument of BiSeNetV2: value}, of the layers that narrow.py narrows. Ends the program if the weights, which `path`
    holds, are of no such network."""
    try:
        return {'head_channels': len(weights['head.0.0.weight']), 'aggregated': len(weights['aggregate.fuse.0.weight']),
                'detail': tuple(len(weights[f'detail.{k}.0.weight']) for k in range(len(DETAIL_CHANNELS)))}
    except KeyError as missing:
        raise SystemExit(f"'{path}' is not this network: it has no {missing}") from None


def network_of(weights, path, two_scales=False):
    """@return a network of the widths of the weights, which `path` holds, ready to infer"""
    model = (TwoScales if two_scales else BiSeNetV2)(len(NAMES), **widths(weights, path))
    load_weights(model, weights, path)
    return model.eval()


def load_network(path, two_scales=False):
    """@return the averaged network of a checkpoint, ready to infer, and the checkpoint."""
    checkpoint = load_checkpoint(path)
    return network_of(checkpoint['average'], path, two_scales), checkpoint


class OnnxNetwork:
    """An exported network, float or quantised, called as a checkpoint's is; its size is fixed."""

    def __init__(self, path):
        try:
            import onnxruntime
        except ImportError as error:
            raise SystemExit(f"{error}: to run '{path}' needs `pip install onnxruntime`") from None
        try:
            self.session = onnxruntime.InferenceSession(path, providers=['CPUExecutionProvider'])
        except Exception as error:  # the runtime's own classes
            raise SystemExit(f"network '{path}' cannot be loaded: {error}") from None
        image = self.session.get_inputs()[0]
        self.name, self.takes_bytes = image.name, image.type == 'tensor(uint8)'
        height, width = image.shape[1:3] if self.takes_bytes else image.shape[2:]
        classes = self.session.get_outputs()[0].shape[1]
        if classes != len(NAMES):
            raise SystemExit(f"network '{path}' gives {classes} classes, must give our {len(NAMES)}")
        self.size = (width, height)

    def eval(self):
        return self

    def __call__(self, images):
        images = images.numpy()
        if self.takes_bytes:
            images = np.rint((images.transpose(0, 2, 3, 1) * STD + MEAN) * 255).astype(np.uint8)
        return torch.from_numpy(self.session.run(None, {self.name: images})[0])


def weights_of_small(graph):
    """@return {name: float32 array} of the weights that an ONNX graph of export.py --small stores in 8 bits"""
    from onnx import numpy_helper
    stored = {weights.name: weights for weights in graph.initializer}
    found = {}
    for node in graph.node:
        if node.op_type == 'DequantizeLinear' and set(node.input) <= stored.keys():
            values, scale = (numpy_helper.to_array(stored[name]) for name in node.input)
            found[node.output[0]] = values * scale.reshape(-1, *[1] * (values.ndim - 1))
    return found


def read_weights(path):
    """@return {name: tensor} of a checkpoint's averaged network, of a network that export.py wrote, or, of the semantic branch alone,
    of the public one (ready_network.py). Ends the program if the file is none of these."""
    if path.endswith('.onnx'):
        try:
            import onnx
            from onnx import numpy_helper
        except ImportError as error:
            raise SystemExit(f"{error}: to read '{path}' needs `pip install onnx`") from None
        try:
            graph = onnx.load(path).graph
        except OSError as error:
            raise SystemExit(f"network '{path}' cannot be read: {error.strerror}") from None
        except Exception as error:  # protobuf's own, of a class that differs between its versions
            raise SystemExit(f"'{path}' is no ONNX file: {error}") from None
        if is_ready_network(graph):
            return weights_of_ready_network(graph, path)
        found = {w.name: torch.tensor(numpy_helper.to_array(w)).float() for w in graph.initializer}
        found.update((name, torch.tensor(values)) for name, values in weights_of_small(graph).items())
        for node in graph.node:
            if node.op_type == 'Identity' and node.input[0] in found:  # equal ones are stored once
                found[node.output[0]] = found[node.input[0]]
    else:
        found = load_checkpoint(path)['average']
    return found


def load_weights(model, found, path):
    """Gives a model the weights that read_weights found in a file. Ends the program if they do not
    fit."""
    wanted = model.state_dict()
    fitting = {name: found[name] for name, w in wanted.items() if name in found and found[name].shape == w.shape}
    lacking = [name for name, w in wanted.items()
               if w.dtype.is_floating_point and name not in fitting]
    if lacking:
        raise SystemExit(f"'{path}' is not this network: {len(lacking)} of its weights are missing or of another shape, "
                         f'{lacking[0]} for one')
    model.load_state_dict(fitting, strict=False)


def write_sidecar(path, size, title):
    def numbers(values):
        return '[' + ', '.join(str(v) for v in values) + ']'

    lines = ['# Written by models/training/export.py; models/README.md describes the form.',
             f'name: {title}', 'license: BSD-3-Clause AND Apache-2.0', 'input:', f'  width: {size[0]}', f'  height: {size[1]}',
             '  layout: nchw', '  type: float32', '  channels: rgb', '  resize: stretch', f'  scale: {1 / 255}',
             f'  mean: {numbers(MEAN)}', f'  std: {numbers(STD)}', 'output:', '  name: logits', '  kind: logits',
             '  layout: nchw', f'  stride: {STRIDE}', f"classes: [{', '.join(NAMES)}]", 'labels:']
    for name, mobility, colour in CLASSES[1:]:
        lines.append(f'  - {{name: {name}, mobility: {mobility}, color: {numbers(colour)}}}')
    with open(path, 'w', encoding='utf-8') as out:
        out.write('\n'.join(lines) + '\n')

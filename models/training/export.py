#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The semantic_vslam authors
# SPDX-License-Identifier: BSD-3-Clause
"""Writes a checkpoint as ONNX with its sidecar: OUT.onnx and OUT.yaml, ready for segmentation.model.

usage: export.py CHECKPOINT.pt OUT.onnx [--size WIDTHxHEIGHT] [--small] [--favour-people 0.3] [--two-scales]

--favour-people is added to the person's logit: one who is missed enters pose and map, one too many costs a piece of the map.

--two-scales looks at the image at half its size too, for people who fill the view (bisenetv2.TwoScales); a quarter more work.

--small stores the weights in 8 bits, a quarter of the file; the network still computes in float (needs the Python package onnx).
"""
import argparse
import inspect
import os
import warnings

import numpy as np
import torch

from classes import PERSON
from network_file import load_network, write_sidecar
from train import parse_size


def export(model, path, size):
    options = {'dynamo': False} if 'dynamo' in inspect.signature(torch.onnx.export).parameters else {}
    options['training'] = torch.onnx.TrainingMode.PRESERVE  # else normalisations become part of the convolutions' weights, which
    # the runtime does as well, and train.py --from could not read them
    with warnings.catch_warnings():
        warnings.simplefilter('ignore')  # PyTorch warns that sizes become constants, which is what we want
        torch.onnx.export(model, torch.zeros(1, 3, size[1], size[0]), path, input_names=['image'],
                          output_names=['logits'], opset_version=13, **options)
    write_sidecar(os.path.splitext(path)[0] + '.yaml', size, 'BiSeNet V2 on MobileNetV2, indoor classes')


def store_small(path):
    """Turns the convolutions' weights of an ONNX file to 8 bits, with a scale for each output channel. They are turned back when
    the network runs; its values in between stay in 32 bits, which quantize.py changes too."""
    try:
        import onnx
        from onnx import numpy_helper  # which onnx 1.12, Debian's, does not bring by itself
    except ImportError as error:
        raise SystemExit(f'{error}: --small needs `pip install onnx`') from None
    model = onnx.load(path)
    kept, nodes = [], []
    for weights in model.graph.initializer:
        values = numpy_helper.to_array(weights)
        if values.ndim != 4:
            kept.append(weights)
            continue
        largest = np.abs(values).max(axis=(1, 2, 3))
        scale = np.where(largest > 0, largest / 127, 1).astype(np.float32)
        small = np.rint(values / scale[:, None, None, None]).astype(np.int8)
        names = [weights.name + '_8', weights.name + '_scale']
        kept += [numpy_helper.from_array(array, name) for array, name in zip((small, scale), names)]
        nodes.append(onnx.helper.make_node('DequantizeLinear', names, [weights.name], axis=0))
    nodes += list(model.graph.node)
    del model.graph.node[:], model.graph.initializer[:]
    model.graph.node.extend(nodes)
    model.graph.initializer.extend(kept)
    onnx.checker.check_model(model)
    onnx.save(model, path)


def main(argv=None):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('checkpoint')
    parser.add_argument('out')
    parser.add_argument('--size', type=parse_size, help='of the input, px; that of the training otherwise')
    parser.add_argument('--favour-people', type=float, default=0.0, help='logit; 0.3 makes a person 1.35 times as likely')
    parser.add_argument('--two-scales', action='store_true')
    parser.add_argument('--small', action='store_true')
    args = parser.parse_args(argv)
    if not args.out.endswith('.onnx'):
        raise SystemExit(f"'{args.out}' must end in .onnx")
    model, checkpoint = load_network(args.checkpoint, args.two_scales)
    with torch.no_grad():
        model.head[-1].bias[PERSON] += args.favour_people
    export(model, args.out, args.size or tuple(checkpoint['size']))
    if args.small:
        store_small(args.out)
    print(f'{args.out}: {os.path.getsize(args.out) / 1e6:.1f} MB, step {checkpoint["step"]}')


if __name__ == '__main__':
    main()

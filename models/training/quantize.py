#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The semantic_vslam authors
# SPDX-License-Identifier: BSD-3-Clause
"""Quantises an exported network to 8-bit integers, calibrated on images like those it will see.

usage: quantize.py IN.onnx OUT.onnx IMAGE_DIR ... [--count 60]      (needs the Python packages onnx and onnxruntime)

Copies the sidecar. Weights take 7 bits: processors without VNNI add two products in 16 bits, which 8 would overflow. Compare the
two networks before use (measure_segmentation, label_images): on such a processor the float one may be as fast.
"""
import argparse
import glob
import os
import re
import shutil

import cv2
import numpy as np

from network_file import MEAN, STD, weights_of_small

# An activation's range holds all but its TAIL smallest and largest values in SHARE of the images, and beyond it clips. On one
# image in ten a few activations are a thousand times as large as usual; a range that holds them tells nothing else apart. Two in
# ten left out keep the logits nearest to those of float (README.md).
TAIL = 1e-4
SHARE = 0.8


class Images:
    """Calibration images as the C++ side would feed them: stretched to the input, RGB, normalised, planar."""

    def __init__(self, paths, size):
        self.paths, self.size = iter(paths), size

    def get_next(self):
        path = next(self.paths, None)
        if path is None:
            return None
        image = cv2.imread(path)
        if image is None:
            raise SystemExit(f"'{path}' does not load as an image")
        image = cv2.cvtColor(cv2.resize(image, self.size), cv2.COLOR_BGR2RGB)
        planar = ((image / 255 - MEAN) / STD).astype(np.float32).transpose(2, 0, 1)
        return {'image': planar[None]}


def read_size(sidecar):
    try:
        with open(sidecar, encoding='utf-8') as text:
            content = text.read()
    except OSError as error:
        raise SystemExit(f"sidecar '{sidecar}' cannot be read: {error.strerror}; export.py writes it beside the network") from None
    return tuple(int(re.search(rf'^\s+{side}: (\d+)', content, re.MULTILINE).group(1)) for side in ('width', 'height'))


def prepare(network, out):
    """Writes a float network as it is best quantised: normalisations are part of the convolutions, and each convolution with
    several outputs for every input channel (gather-and-expand's) is a depthwise one over as many copies of its input. The sums are
    the same, in another order of the channels, and the runtime, which has a kernel for them, needs 0.7 times the time for all."""
    import onnx
    from onnxruntime.quantization.shape_inference import quant_pre_process
    model = onnx.load(network)
    plain = weights_of_small(model.graph)  # not seen as weights, else, and no normalisation enters them
    nodes = [node for node in model.graph.node if node.output[0] not in plain]
    del model.graph.node[:]
    model.graph.node.extend(nodes)
    model.graph.initializer.extend(onnx.numpy_helper.from_array(values, name) for name, values in plain.items())
    quant_pre_process(model, out)
    model = onnx.load(out)
    _give_each_its_own(model.graph)
    _split_expansions(model.graph)
    _halve_first(model.graph)
    _share_equal(model.graph)
    onnx.checker.check_model(model)
    onnx.save(model, out)


def _give_each_its_own(graph):
    """Copies weights that several convolutions use, so that each can be changed for itself."""
    weights, used = {w.name: w for w in graph.initializer}, set()
    for node in graph.node:
        for i, name in enumerate(node.input) if node.op_type == 'Conv' else ():
            if name in used:
                graph.initializer.add().CopyFrom(weights[name])
                node.input[i] = graph.initializer[-1].name = f'{name}_of_{node.name}'
            elif name in weights:
                used.add(name)


def _share_equal(graph):
    """Stores equal weights of several convolutions once; a bias is quantised by what comes in, and stays for itself."""
    first, same = {}, {}
    for weights in graph.initializer:
        content = (tuple(weights.dims), weights.raw_data)
        if len(weights.dims) == 4 and first.setdefault(content, weights.name) != weights.name:
            same[weights.name] = first[content]
    for node in graph.node:
        for i, name in enumerate(node.input):
            node.input[i] = same.get(name, name)
    kept = [weights for weights in graph.initializer if weights.name not in same]
    del graph.initializer[:]
    graph.initializer.extend(kept)


def _split_expansions(graph):
    from onnx import helper, numpy_helper
    weights = {w.name: w for w in graph.initializer}

    def group(node):
        return next(a for a in node.attribute if a.name == 'group')

    def reorder(names, order, axis):
        for name in names:
            values = np.take(numpy_helper.to_array(weights[name]), order, axis)
            weights[name].CopyFrom(numpy_helper.from_array(values, name))

    for node in [n for n in graph.node if n.op_type == 'Conv']:
        inputs, outputs = group(node).i, weights[node.input[1]].dims[0]
        if inputs in (1, outputs):
            continue
        order = np.arange(outputs).reshape(inputs, -1).T.ravel()  # all first outputs, then all second ones
        reorder(node.input[1:], order, 0)
        group(node).i = outputs
        copies = helper.make_node('Concat', [node.input[0]] * (outputs // inputs), [node.name + '_copies'], axis=1)
        graph.node.insert(list(graph.node).index(node), copies)
        node.input[0] = copies.output[0]
        while node.op_type != 'Conv' or group(node).i > 1:  # to the one that sums over the channels
            node, = (n for n in graph.node if node.output[0] in n.input)
            if node.op_type == 'Conv':
                sums = group(node).i == 1
                reorder(node.input[1:2] if sums else node.input[1:], order, 1 if sums else 0)


def _halve_first(graph):
    """Gives the 3x3 convolutions of stride 2 on the image, and on the pooled image of a network for two scales, an image of half the
    size with four times the channels, of which they are 2x2 convolutions and, in ONNX Runtime, four times as fast."""
    from onnx import helper, numpy_helper
    weights = {w.name: w for w in graph.initializer}
    image = graph.input[0].name
    images = [image] + [node.output[0] for node in graph.node if node.op_type == 'AveragePool' and image in node.input]

    def attributes(node):
        return {a.name: helper.get_attribute_value(a) for a in node.attribute}

    for node in [n for n in graph.node if n.op_type == 'Conv' and n.input[0] in images]:
        has = attributes(node)
        if (has['kernel_shape'], has['strides'], has['pads'], has['group']) != ([3, 3], [2, 2], [1, 1, 1, 1], 1):
            continue
        values = numpy_helper.to_array(weights[node.input[1]])
        padded = np.pad(values, ((0, 0), (0, 0), (1, 0), (1, 0)))  # from one pixel further up and left: two blocks of 2x2
        outputs, channels = values.shape[:2]
        blocks = padded.reshape(outputs, channels, 2, 2, 2, 2).transpose(0, 3, 5, 1, 2, 4).reshape(outputs, 4 * channels, 2, 2)
        weights[node.input[1]].CopyFrom(numpy_helper.from_array(np.ascontiguousarray(blocks), node.input[1]))
        for attribute in node.attribute:
            if attribute.name in ('kernel_shape', 'strides', 'pads'):
                del attribute.ints[:]
                attribute.ints.extend({'kernel_shape': [2, 2], 'strides': [1, 1], 'pads': [1, 1, 0, 0]}[attribute.name])
        halved = node.input[0] + '_halved'
        if not any(halved in n.output for n in graph.node):
            place = list(graph.node).index(node)
            graph.node.insert(place, helper.make_node('SpaceToDepth', [node.input[0]], [halved], halved, blocksize=2))
        node.input[0] = halved


def after_convolutions(graph):
    """@return names of the nodes that only work on the logits, in which two scales are joined"""
    lead_on, names = set(), []
    for node in reversed(graph.node):
        if node.op_type == 'Conv' or lead_on.intersection(node.output):
            lead_on.update(node.input)
        else:
            names.append(node.name)
    return names


def activation_ranges(prepared, images):
    """@return {activation: (least, largest)} of a float network over calibration images"""
    import onnx
    import onnxruntime
    model = onnx.load(prepared)
    names = [name for node in model.graph.node for name in node.output]
    known = {output.name for output in model.graph.output}
    model.graph.output.extend(onnx.ValueInfoProto(name=name) for name in names if name not in known)
    options = onnxruntime.SessionOptions()
    options.graph_optimization_level = onnxruntime.GraphOptimizationLevel.ORT_DISABLE_ALL  # fused layers give no output
    session = onnxruntime.InferenceSession(model.SerializeToString(), options, providers=['CPUExecutionProvider'])
    ranges = []
    while (inputs := images.get_next()) is not None:
        ranges.append([_without_tails(values.ravel()) for values in session.run(names, inputs)])
    least, largest = np.moveaxis(np.array(ranges), 2, 0)
    least, largest = np.quantile(least, 1 - SHARE, axis=0), np.quantile(largest, SHARE, axis=0)
    return {name: (min(low, 0.0), max(high, 1e-3)) for name, low, high in zip(names, least, largest)}


def _without_tails(values):
    left_out = int(TAIL * values.size)
    ordered = np.partition(values, (left_out, values.size - 1 - left_out))
    return ordered[left_out], ordered[-1 - left_out]


def main(argv=None):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('network')
    parser.add_argument('out')
    parser.add_argument('images', nargs='+', help='folders of .jpg or .png')
    parser.add_argument('--count', type=int, default=60, help='images to calibrate on, as many of each folder')
    args = parser.parse_args(argv)
    try:
        import onnx
        from onnxruntime.quantization import QuantFormat, QuantType, quantize_static
    except ImportError as error:
        raise SystemExit(f'{error}: quantising needs `pip install onnx onnxruntime`') from None
    sidecar = os.path.splitext(args.network)[0] + '.yaml'
    size = read_size(sidecar)
    paths = [path for folder in args.images for path in spread(folder, -(-args.count // len(args.images)))]
    prepared = args.out + '.float'
    prepare(args.network, prepared)
    graph = onnx.load(prepared).graph
    in_float = [node.name for node in graph.node if node.op_type == 'BatchNormalization'] + after_convolutions(graph)  # little work
    ranges = activation_ranges(prepared, Images(paths, size))
    overrides = {name: [{'rmin': np.float32(low), 'rmax': np.float32(high)}] for name, (low, high) in ranges.items()}
    quantize_static(prepared, args.out, Images(paths[:1], size), quant_format=QuantFormat.QDQ, per_channel=True,
                    reduce_range=True, activation_type=QuantType.QUInt8, weight_type=QuantType.QInt8,
                    nodes_to_exclude=in_float, extra_options={'TensorQuantOverrides': overrides})
    os.remove(prepared)
    shutil.copyfile(sidecar, os.path.splitext(args.out)[0] + '.yaml')
    print(f'{args.out}: {os.path.getsize(args.out) / 1e6:.1f} MB, calibrated on {len(paths)} images')


def spread(folder, count):
    """@return paths of up to `count` images of a folder, spread evenly"""
    paths = sorted(glob.glob(os.path.join(folder, '*.jpg')) + glob.glob(os.path.join(folder, '*.png')))
    if not paths:
        raise SystemExit(f"'{folder}' holds no .jpg or .png")
    return paths[::max(1, -(-len(paths) // count))]


if __name__ == '__main__':
    main()

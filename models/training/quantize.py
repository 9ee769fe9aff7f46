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

import cv2
import numpy as np

from bisenetv2 import SEMANTIC_CHANNELS
from network_file import MEAN, STD, weights_of_small

# An activation's range holds all but its TAIL smallest and largest values in SHARE of the images, and beyond it clips. On one
# image in ten a few activations are a thousand times as large as usual; a range that holds them tells nothing else apart. Two in
# ten left out keep the logits nearest to those of float (README.md).
TAIL = 1e-4
SHARE = 0.8
GREY = 114  # of 255, the mean of photographs' three: the pixel value that is zero to the quantised network
REGROUPING = 'Transpose', 'Reshape'
STEM = SEMANTIC_CHANNELS[0]


class Images:
    """Calibration images as the C++ side would feed them, less GREY: stretched to the input, RGB."""

    def __init__(self, paths, size):
        self.paths, self.size = iter(paths), size

    def get_next(self):
        path = next(self.paths, None)
        if path is None:
            return None
        image = cv2.imread(path)
        if image is None:
            raise SystemExit(f"'{path}' does not load as an image")
        return {'image': cv2.cvtColor(cv2.resize(image, self.size), cv2.COLOR_BGR2RGB)[None].astype(np.float32) - GREY}


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
    if plain:
        print(f"'{network}' has weights of 8 bits (export.py --small), which are rounded a second time now; an export without it is nearer")
    nodes = [node for node in model.graph.node if node.output[0] not in plain]
    del model.graph.node[:]
    model.graph.node.extend(nodes)
    model.graph.initializer.extend(onnx.numpy_helper.from_array(values, name) for name, values in plain.items())
    quant_pre_process(model, out)
    model = onnx.load(out)
    _give_each_its_own(model.graph)
    _split_expansions(model.graph)
    _take_bytes(model.graph)
    _gather_more(model.graph)
    _drop_unused(model.graph)
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


def _drop_unused(graph):
    """Takes the nodes away whose output nothing reads; the runtime would compute it."""
    used = {output.name for output in graph.output}
    for node in reversed(list(graph.node)):
        if used.isdisjoint(node.output):
            graph.node.remove(node)
        else:
            used.update(node.input)


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


def _take_bytes(graph):
    """Gives a network images as cameras do, 1 x H x W x 3 less GREY (_feed_bytes makes them whole): normalisation becomes part of
    the convolutions that read the image, or its average over 2x2 of a network for two scales. What they pad the image with is GREY
    then, a sixth of a standard deviation off the mean at most."""
    from onnx import helper, numpy_helper
    weights, image = {w.name: w for w in graph.initializer}, graph.input[0]
    pools = [node for node in graph.node if node.op_type == 'AveragePool' and node.input[0] == image.name]
    convolutions = [node for node in graph.node
                    if node.op_type == 'Conv' and node.input[0] in [image.name] + [pool.output[0] for pool in pools]]
    if not convolutions or any(weights[node.input[1]].dims[1] != 3 for node in convolutions):
        raise SystemExit('this network does not begin with convolutions of an image of three channels; export.py writes those that do')
    gain, offset = 1 / (255 * np.array(STD)), (GREY / 255 - np.array(MEAN)) / np.array(STD)
    for node in convolutions:
        values, bias = (numpy_helper.to_array(weights[name]) for name in node.input[1:])
        for name, changed in zip(node.input[1:], (values * gain[:, None, None], bias + values.sum((2, 3)) @ offset)):
            weights[name].CopyFrom(numpy_helper.from_array(changed.astype(np.float32), name))
    planes = helper.make_node('Transpose', [image.name], [image.name + '_planes'], image.name + '_planes', perm=[0, 3, 1, 2])
    for node in graph.node:
        node.input[:] = [planes.output[0] if name == image.name else name for name in node.input]
    graph.node.insert(0, planes)
    dims = image.type.tensor_type.shape.dim
    for dim, value in zip(dims, [dim.dim_value for dim in (dims[0], dims[2], dims[3], dims[1])]):
        dim.dim_value = value
    for pool in pools:
        mean = numpy_helper.from_array(np.eye(3, dtype=np.float32)[:, :, None, None].repeat(2, 2).repeat(2, 3) / 4, pool.name + '_mean')
        graph.initializer.append(mean)
        pool.op_type = 'Conv'
        pool.input.append(mean.name)
        del pool.attribute[:]
        pool.attribute.extend(helper.make_node('Conv', [], [], kernel_shape=[2, 2], strides=[2, 2], pads=[0] * 4, group=1).attribute)
        _in_blocks(graph, pool, 16)
    for node in convolutions:
        _in_blocks(graph, node, 4)


def _gather_more(graph):
    """The stem's convolution of single pixels has too few channels too."""
    sizes = {w.name: tuple(w.dims) for w in graph.initializer}
    for node in [n for n in graph.node if n.op_type == 'Conv' and sizes[n.input[1]] == (STEM // 2, STEM, 1, 1)]:
        _in_blocks(graph, node, 4)


def _in_blocks(graph, node, pixels):
    """Turns a convolution of few channels into one of `pixels` times as many, at blocks of a row. It multiplies zeros too, but ONNX
    Runtime spends the time of such convolutions on gathering, with a copy for each pixel of the kernel: from 704x544x3 to
    352x272x24 it needs 2.9 ms in blocks of 2 pixels, 1.1 of 4, 1.3 of 8."""
    from onnx import helper, numpy_helper
    stored = next(w for w in graph.initializer if w.name == node.input[1])
    values = numpy_helper.to_array(stored)
    outputs, channels, height, width = values.shape
    has = {a.name: a for a in node.attribute}
    stride, left = has['strides'].ints[1], has['pads'].ints[1]
    count = pixels // stride  # of outputs in a block
    before, after = -(-left // pixels), ((count - 1) * stride - left + width - 1) // pixels  # further blocks that they need
    blocks = np.zeros((count, outputs, before + 1 + after, pixels, channels, height), values.dtype)
    for k in range(count):
        for u in range(width):
            block, pixel = divmod(k * stride - left + u, pixels)
            blocks[k, :, before + block, pixel] = values[..., u]
    blocks = blocks.transpose(0, 1, 3, 4, 5, 2).reshape(count * outputs, pixels * channels, height, -1)
    stored.CopyFrom(numpy_helper.from_array(blocks, stored.name))
    if len(node.input) > 2:
        bias = next(w for w in graph.initializer if w.name == node.input[2])
        bias.CopyFrom(numpy_helper.from_array(np.tile(numpy_helper.to_array(bias), count), bias.name))
    has['kernel_shape'].ints[1], has['strides'].ints[1] = before + 1 + after, 1
    has['pads'].ints[1], has['pads'].ints[3] = before, after

    def regroup(source, result, channels):
        """@return nodes that make of a tensor's rows such of so many channels"""
        names = [result + part for part in ('_shape', '_rows', '_regrouped')]
        graph.initializer.append(numpy_helper.from_array(np.array([0, 0, -1, channels]), names[0]))
        rows = [n.input[0] for n in graph.node if n.output[0] == source and n.op_type == 'Transpose']  # back, or there already
        return ([] if rows else [helper.make_node('Transpose', [source], names[1:2], names[1], perm=[0, 2, 3, 1])]) + [
                helper.make_node('Reshape', [rows[0] if rows else names[1], names[0]], names[2:3], names[2]),
                helper.make_node('Transpose', names[2:3], [result], result, perm=[0, 3, 1, 2])]

    place = list(graph.node).index(node)
    for k, added in enumerate(regroup(node.input[0], node.name + '_blocks', pixels * channels)):
        graph.node.insert(place + k, added)
    node.input[0] = node.name + '_blocks'
    users = [user for user in graph.node if node.output[0] in user.input]
    last = users[0] if users[0].op_type == 'Relu' else node  # which becomes part of the convolution
    result = last.output[0]
    last.output[0] = node.name + '_of_blocks'
    if last is not node:
        node.output[0] = last.input[0] = node.name + '_sums'
    for k, added in enumerate(regroup(last.output[0], result, outputs)):
        graph.node.insert(list(graph.node).index(last) + 1 + k, added)


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
    names = [node.output[0] for node in model.graph.node if node.op_type not in REGROUPING]
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
    ranges.update(dict.fromkeys(pixels(graph), (-GREY, 255 - GREY)))
    overrides = {name: [{'rmin': np.float32(low), 'rmax': np.float32(high)}] for name, (low, high) in ranges.items()}
    quantize_static(prepared, args.out, Images(paths[:1], size), quant_format=QuantFormat.QDQ, per_channel=True,
                    reduce_range=True, activation_type=QuantType.QUInt8, weight_type=QuantType.QInt8,
                    nodes_to_exclude=in_float, extra_options={'TensorQuantOverrides': overrides})
    os.remove(prepared)
    _feed_bytes(args.out)
    write_sidecar_of_bytes(sidecar, os.path.splitext(args.out)[0] + '.yaml')
    print(f'{args.out}: {os.path.getsize(args.out) / 1e6:.1f} MB, calibrated on {len(paths)} images')


def pixels(graph):
    """@return names of the tensors that are the image, whole or regrouped"""
    names = {graph.input[0].name}
    for node in graph.node:
        if node.op_type in REGROUPING and node.input[0] in names:
            names.add(node.output[0])
    return names


def _feed_bytes(path):
    """Makes a quantised network's input the bytes that it turns pixels into, and saves it."""
    import onnx
    model = onnx.load(path)
    graph, images = model.graph, pixels(model.graph)
    to_bytes = {node.output[0]: node for node in graph.node if node.op_type == 'QuantizeLinear' and node.input[0] in images}
    for node in graph.node:
        node.input[:] = [to_bytes[name].input[0] if name in to_bytes else name for name in node.input]
    for node in to_bytes.values():
        graph.node.remove(node)
    graph.input[0].type.tensor_type.elem_type = onnx.TensorProto.UINT8
    del graph.value_info[:]  # of floats
    onnx.checker.check_model(model, full_check=True)
    onnx.save(model, path)


def write_sidecar_of_bytes(sidecar, out):
    with open(sidecar, encoding='utf-8') as text:
        content = text.read()
    content = content.replace('  layout: nchw\n  type: float32\n', '  layout: nhwc\n  type: uint8\n', 1)
    content = re.sub(r'^  (scale|mean|std):.*\n', '', content, flags=re.MULTILINE)
    with open(out, 'w', encoding='utf-8') as text:
        text.write(content)


def spread(folder, count):
    """@return paths of up to `count` images of a folder, spread evenly"""
    paths = sorted(glob.glob(os.path.join(folder, '*.jpg')) + glob.glob(os.path.join(folder, '*.png')))
    if not paths:
        raise SystemExit(f"'{folder}' holds no .jpg or .png")
    return paths[::max(1, -(-len(paths) // count))]


if __name__ == '__main__':
    main()

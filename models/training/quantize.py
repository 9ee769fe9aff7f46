#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The semantic_vslam authors
# SPDX-License-Identifier: BSD-3-Clause
"""Quantises an exported network to 8-bit integers, calibrated on images like those it will see.

usage: quantize.py IN.onnx OUT.onnx IMAGE_DIR ... [--count 60]      (needs the Python packages onnx and onnxruntime)

OUT takes the image's bytes, and its sidecar says so. Weights take 7 bits: processors without VNNI add two products in 16 bits, which
8 would overflow. Compare the two networks before use (measure_segmentation, label_images): on such a processor the float one may be
as fast.
"""
import argparse
import glob
import os
import re

import cv2
import numpy as np
import yaml

from fast_graph import REGROUPING, grey, pixels, prepare

# An activation's range holds all but its TAIL smallest and largest values in SHARE of the images, and beyond it clips. On one
# image in ten a few activations are a thousand times as large as usual; a range that holds them tells nothing else apart. Two in
# ten left out keep the logits nearest to those of float (README.md).
TAIL = 1e-4
SHARE = 0.8
FORM = {'layout': 'nchw', 'type': 'float32', 'channels': 'rgb', 'resize': 'stretch'}  # of the input


class Images:
    """Calibration images as the C++ side would feed them, less the grey that is zero: stretched to the input, RGB."""

    def __init__(self, paths, size, zero):
        self.paths, self.size, self.zero = iter(paths), size, zero

    def get_next(self):
        path = next(self.paths, None)
        if path is None:
            return None
        image = cv2.imread(path)
        if image is None:
            raise SystemExit(f"'{path}' does not load as an image")
        return {'image': cv2.cvtColor(cv2.resize(image, self.size), cv2.COLOR_BGR2RGB)[None].astype(np.float32) - self.zero}


def read_input(sidecar):
    """@return size (width, height), px, and mean and std of each channel, 0 to 255, of a network's input by its sidecar. Ends the
    program if it is not of the form that export.py writes."""
    try:
        with open(sidecar, encoding='utf-8') as text:
            has = yaml.safe_load(text)['input']
        form = {key: has[key] for key in FORM}
        if form != FORM:
            raise SystemExit(f"sidecar '{sidecar}' says {form}, which cannot be quantised; it must be {FORM}")
        mean, std = (np.array(has[key], float) / has['scale'] for key in ('mean', 'std'))
        size = int(has['width']), int(has['height'])
    except OSError as error:
        raise SystemExit(f"sidecar '{sidecar}' cannot be read: {error.strerror}; export.py writes it beside the network") from None
    except KeyError as missing:
        raise SystemExit(f"sidecar '{sidecar}' has no {missing} of its input; export.py writes all that is needed") from None
    except (yaml.YAMLError, TypeError, ValueError) as error:
        raise SystemExit(f"sidecar '{sidecar}' is none: {str(error).splitlines()[0]}; export.py writes one") from None
    return size, mean, std


def of_logits(graph):
    """@return names of the convolutions that give the logits and of the nodes after them, in which logits are joined: little work,
    and rounding them moves the borders of what is found"""
    lead_on, names = set(), []
    for node in reversed(graph.node):
        if lead_on.intersection(node.output):
            lead_on.update(node.input)
        else:
            names.append(node.name)
            if node.op_type == 'Conv':
                lead_on.update(node.input)
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
    size, mean, std = read_input(sidecar)
    paths = [path for folder in args.images for path in spread(folder, -(-args.count // len(args.images)))]
    prepared = args.out + '.float'
    prepare(args.network, prepared, mean, std)
    graph = onnx.load(prepared).graph
    ranges = activation_ranges(prepared, Images(paths, size, grey(mean)))
    ranges.update(dict.fromkeys(pixels(graph), (-grey(mean), 255 - grey(mean))))
    overrides = {name: [{'rmin': np.float32(low), 'rmax': np.float32(high)}] for name, (low, high) in ranges.items()}
    quantize_static(prepared, args.out, Images(paths[:1], size, grey(mean)), quant_format=QuantFormat.QDQ, per_channel=True,
                    reduce_range=True, activation_type=QuantType.QUInt8, weight_type=QuantType.QInt8,
                    nodes_to_exclude=of_logits(graph), extra_options={'TensorQuantOverrides': overrides})
    os.remove(prepared)
    _feed_bytes(args.out)
    _write_sidecar_of_bytes(sidecar, os.path.splitext(args.out)[0] + '.yaml')
    print(f'{args.out}: {os.path.getsize(args.out) / 1e6:.1f} MB, calibrated on {len(paths)} images')


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


def _write_sidecar_of_bytes(sidecar, out):
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

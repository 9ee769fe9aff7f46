#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The semantic_vslam authors
# SPDX-License-Identifier: BSD-3-Clause
"""Quantises an exported network to 8-bit integers, calibrated on images like those it will see.

usage: quantize.py IN.onnx OUT.onnx IMAGE_DIR [--count 100]       (needs the Python packages onnx and onnxruntime)

Copies the sidecar. The last layer stays in float: it is small, and its scores decide the labels. Compare the two networks
before use (label_images, evaluate): on a processor without VNNI the float one may be faster, and it is never less right.
"""
import argparse
import glob
import os
import re
import shutil

import cv2
import numpy as np

from network_file import MEAN, STD


class Images:
    """Calibration images as the C++ side would feed them: stretched to the input, RGB, normalised, planar."""

    def __init__(self, paths, size):
        self.paths, self.size = iter(paths), size

    def get_next(self):
        path = next(self.paths, None)
        if path is None:
            return None
        image = cv2.cvtColor(cv2.resize(cv2.imread(path), self.size), cv2.COLOR_BGR2RGB)
        planar = ((image / 255 - MEAN) / STD).astype(np.float32).transpose(2, 0, 1)
        return {'image': planar[None]}


def read_size(sidecar):
    with open(sidecar, encoding='utf-8') as text:
        content = text.read()
    return tuple(int(re.search(rf'^\s+{side}: (\d+)', content, re.MULTILINE).group(1)) for side in ('width', 'height'))


def main(argv=None):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('network')
    parser.add_argument('out')
    parser.add_argument('images', help='folder of .jpg or .png')
    parser.add_argument('--count', type=int, default=100, help='images to calibrate on')
    args = parser.parse_args(argv)
    try:
        import onnx
        from onnxruntime.quantization import QuantFormat, QuantType, quantize_static
        from onnxruntime.quantization.shape_inference import quant_pre_process
    except ImportError as error:
        raise SystemExit(f'{error}: quantising needs `pip install onnx onnxruntime`') from None
    sidecar = os.path.splitext(args.network)[0] + '.yaml'
    paths = sorted(glob.glob(os.path.join(args.images, '*.jpg')) + glob.glob(os.path.join(args.images, '*.png')))
    if not paths:
        raise SystemExit(f"'{args.images}' holds no .jpg or .png")
    paths = paths[::max(1, len(paths) // args.count)][:args.count]
    prepared = args.out + '.float'
    quant_pre_process(args.network, prepared)
    last = [node.name for node in onnx.load(prepared).graph.node if node.op_type == 'Conv'][-1]
    quantize_static(prepared, args.out, Images(paths, read_size(sidecar)), quant_format=QuantFormat.QDQ, per_channel=True,
                    activation_type=QuantType.QUInt8, weight_type=QuantType.QInt8, nodes_to_exclude=[last])
    os.remove(prepared)
    shutil.copyfile(sidecar, os.path.splitext(args.out)[0] + '.yaml')
    print(f'{args.out}: {os.path.getsize(args.out) / 1e6:.1f} MB, calibrated on {len(paths)} images')


if __name__ == '__main__':
    main()

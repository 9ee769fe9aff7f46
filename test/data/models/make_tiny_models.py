#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The semantic_vslam authors
# SPDX-License-Identifier: BSD-3-Clause
"""Makes the tiny networks that the segmentation tests run (needs numpy and onnx; the results are committed).

usage: make_tiny_models.py [OUT_DIR]

tiny_logits.onnx     float32 1x3x32x48 -> logits 1x3x4x6 (stride 8): the class is the brightest channel of each 8x8 cell
tiny_labels.onnx     uint8 1x32x48x3 -> int64 1x32x48: 0 where the first channel is below 128, else 1
bisenetv2_coco.onnx  float32 1x3x64x64 -> int64 1x64x64 in 0..170, random weights: the shape of the usual public export of
                     BiSeNet V2 trained on COCO-Stuff, for models/sidecars/bisenetv2_coco.yaml
"""
import os
import sys

import numpy as np
import onnx
from onnx import TensorProto, helper, numpy_helper


def save(path, nodes, inputs, outputs, weights):
    graph = helper.make_graph(nodes, os.path.basename(path), inputs, outputs,
                              [numpy_helper.from_array(value, name) for name, value in weights.items()])
    model = helper.make_model(graph, opset_imports=[helper.make_opsetid('', 13)], producer_name='semantic_vslam')
    model.ir_version = 7
    onnx.checker.check_model(model)
    onnx.save(model, path)
    print(path, os.path.getsize(path), 'bytes')


def tiny_logits(path):
    save(path, [helper.make_node('AveragePool', ['image'], ['logits'], kernel_shape=[8, 8], strides=[8, 8])],
         [helper.make_tensor_value_info('image', TensorProto.FLOAT, [1, 3, 32, 48])],
         [helper.make_tensor_value_info('logits', TensorProto.FLOAT, [1, 3, 4, 6])], {})


def tiny_labels(path):
    save(path, [helper.make_node('Gather', ['image', 'zero'], ['first'], axis=3),
                helper.make_node('Cast', ['first'], ['first_int'], to=TensorProto.INT32),
                helper.make_node('Less', ['first_int', 'half'], ['dark']),
                helper.make_node('Not', ['dark'], ['bright']),
                helper.make_node('Cast', ['bright'], ['labels'], to=TensorProto.INT64)],
         [helper.make_tensor_value_info('image', TensorProto.UINT8, [1, 32, 48, 3])],
         [helper.make_tensor_value_info('labels', TensorProto.INT64, [1, 32, 48])],
         {'zero': np.array(0, np.int64), 'half': np.array(128, np.int32)})


def bisenetv2_coco(path):
    rng = np.random.default_rng(1)
    save(path, [helper.make_node('AveragePool', ['input_image'], ['pooled'], kernel_shape=[8, 8], strides=[8, 8]),
                helper.make_node('Conv', ['pooled', 'weight'], ['coarse'], kernel_shape=[1, 1]),
                helper.make_node('Resize', ['coarse', '', 'scales'], ['logits'], mode='linear'),
                helper.make_node('ArgMax', ['logits'], ['preds'], axis=1, keepdims=0)],
         [helper.make_tensor_value_info('input_image', TensorProto.FLOAT, [1, 3, 64, 64])],
         [helper.make_tensor_value_info('preds', TensorProto.INT64, [1, 64, 64])],
         {'weight': rng.normal(0, 1, (171, 3, 1, 1)).astype(np.float32),
          'scales': np.array([1, 1, 8, 8], np.float32)})


def main():
    out = sys.argv[1] if len(sys.argv) > 1 else os.path.dirname(os.path.abspath(__file__))
    tiny_logits(os.path.join(out, 'tiny_logits.onnx'))
    tiny_labels(os.path.join(out, 'tiny_labels.onnx'))
    bisenetv2_coco(os.path.join(out, 'bisenetv2_coco.onnx'))


if __name__ == '__main__':
    main()

#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The semantic_vslam authors
# SPDX-License-Identifier: BSD-3-Clause
"""Writes hints (hints.py) for the images of labelled folders: the inner features of a ready network, reduced to their
principal components.

usage: teach.py TEACHER.onnx --tensor NAME --data DIR ...        (needs the Python packages onnx and onnxruntime)

TEACHER.onnx takes one NHWC uint8 RGB image of fixed size. NAME is the tensor that holds its features, N x C x H x W or of
any type that scales to it. All folders must be taught in one go: the components are those of their images together.
"""
import argparse
import os

import cv2
import numpy as np

import hints
from dataset import LabelledFolder
from progress import Bar

SAMPLED_PLACES = 50  # of an image, for the principal components


def open_teacher(path, tensor):
    """@return function: RGB image -> features, H x W x C float32"""
    try:
        import onnx
        import onnxruntime
    except ImportError as error:
        raise SystemExit(f'{error}: teaching needs `pip install onnx onnxruntime`') from None
    model = onnx.load(path)
    if tensor not in {name for node in model.graph.node for name in node.output}:
        raise SystemExit(f"'{path}' has no tensor '{tensor}'")
    model.graph.output.append(onnx.ValueInfoProto(name=tensor))
    options = onnxruntime.SessionOptions()
    options.intra_op_num_threads = 1
    options.graph_optimization_level = onnxruntime.GraphOptimizationLevel.ORT_ENABLE_BASIC
    session = onnxruntime.InferenceSession(model.SerializeToString(), options, providers=['CPUExecutionProvider'])
    entry = session.get_inputs()[0]
    _, rows, columns, _ = entry.shape

    def features(image):
        stretched = cv2.resize(image, (columns, rows))
        return session.run([tensor], {entry.name: stretched[None]})[0][0].transpose(1, 2, 0).astype(np.float32)

    return features


def principal_components(samples):
    """@return mean (C) and basis (C x HINTS), scaled so that hints have a mean square of 1"""
    mean = samples.mean(axis=0)
    values, vectors = np.linalg.eigh(np.cov((samples - mean).T))
    strongest = vectors[:, ::-1][:, :hints.HINTS]
    return mean, strongest / np.sqrt(values[::-1][:hints.HINTS].mean())


def main(argv=None):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('teacher')
    parser.add_argument('--tensor', required=True)
    parser.add_argument('--data', nargs='+', required=True, metavar='DIR')
    args = parser.parse_args(argv)
    teacher = open_teacher(args.teacher, args.tensor)
    rng = np.random.default_rng(1)
    seen, samples, bar = {}, [], Bar()
    folders = [LabelledFolder(folder) for folder in args.data]
    for folder in folders:
        os.makedirs(os.path.join(folder.folder, 'hints'), exist_ok=True)
        for index, (path, _) in enumerate(folder.pairs):
            features = teacher(folder.load(index)[0])
            stem = os.path.splitext(os.path.basename(path))[0]
            seen[os.path.join(folder.folder, 'hints', stem + '.npy')] = features.astype(np.float16)
            flat = features.reshape(-1, features.shape[2])
            samples.append(flat[rng.integers(len(flat), size=SAMPLED_PLACES)])
            bar.update(len(seen) / sum(len(f) for f in folders), f'{len(seen)} images')
    mean, basis = principal_components(np.concatenate(samples))
    for path, features in seen.items():
        np.save(path, ((features - mean) @ basis).astype(np.float16))
    print(f'hints for {len(seen)} images')


if __name__ == '__main__':
    main()

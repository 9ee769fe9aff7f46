#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The semantic_vslam authors
# SPDX-License-Identifier: BSD-3-Clause
"""Scores a checkpoint, or a network exported from one, on the held-back fold of labelled folders: IoU per class,
precision and recall of people, and the share taken for people of the images that show nobody.

usage: evaluate.py CHECKPOINT.pt|NETWORK.onnx DIR ... [--size WIDTHxHEIGHT] [--all] [--pictures DIR] [--json]
"""
import argparse
import json
import os

import cv2
import numpy as np

import scores
from classes import CLASSES
from dataset import LabelledFolder
from network_file import OnnxNetwork, load_network
from train import parse_size

COLOURS = np.array([colour for _, _, colour in CLASSES], np.uint8)


def main(argv=None):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('network', help='.pt of train.py or .onnx')
    parser.add_argument('folders', nargs='+')
    parser.add_argument('--size', type=parse_size, help="of a checkpoint's input, px; that of the training otherwise")
    parser.add_argument('--all', action='store_true', help='every image, also those of the training')
    parser.add_argument('--pictures', help='folder for overlays')
    parser.add_argument('--json', action='store_true')
    args = parser.parse_args(argv)
    if args.network.endswith('.onnx'):
        model = OnnxNetwork(args.network)
        size = model.size
        if args.size and args.size != size:
            raise SystemExit(f"'{args.network}' takes {size[0]}x{size[1]} and no other --size")
    else:
        model, checkpoint = load_network(args.network)
        size = args.size or tuple(checkpoint['size'])
    folders = [LabelledFolder(folder) for folder in args.folders]
    if not args.all:
        folders = [folder.split(held_back=True) for folder in folders]

    def draw(path, image, predicted):
        tinted = np.where(predicted[..., None] > 0, image // 2 + COLOURS[predicted] // 2, image)
        name = os.path.splitext(os.path.basename(path))[0] + '.jpg'
        cv2.imwrite(os.path.join(args.pictures, name), tinted[..., ::-1])

    if args.pictures:
        os.makedirs(args.pictures, exist_ok=True)
    confusion = scores.confusion_of(model, folders, size, on_image=draw if args.pictures else None)
    iou, people, false_people = confusion.iou(), confusion.people(), confusion.false_people()
    result = {'images': sum(len(f) for f in folders), 'mean_iou': scores.mean_iou(iou), 'iou': iou, 'precision': people[0],
              'recall': people[1], 'empty_images': len(confusion.empty), 'false_people': false_people}
    whole_mean = sum(iou.values()) / max(1, len(iou))
    if args.json:
        print(json.dumps(result, indent=1))
    else:
        for name, value in iou.items():
            print(f'{name:12s} {value:.3f}')
        print(f"{'mean':12s} {whole_mean:.3f}, {result['mean_iou']:.3f} without background, over {result['images']} images")
        print(f"people: precision {people[0]:.3f}, recall {people[1]:.3f}" + (
            '' if false_people is None else f'; {100 * false_people:.2f} % of {len(confusion.empty)} images without anybody taken for people'))
    return result


if __name__ == '__main__':
    main()

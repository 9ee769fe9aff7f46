#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The semantic_vslam authors
# SPDX-License-Identifier: BSD-3-Clause
"""Checks labels that a segmentation network gave to photographs (label_images --unknown 255) against a detector.

usage: second_opinion.py DETECTOR.onnx DIR        (needs the Python package onnxruntime)

DETECTOR.onnx is a YOLOX network of the 80 classes of COCO. Photographs whose people the two do not agree on are deleted from
DIR/images and DIR/labels. In the others, what is unknown becomes background where the detector suspects none of our classes, and
around people whose labels fill their boxes as bodies do: that a wall is no person, and where a person ends, is worth teaching;
that a keyboard is background is not.
"""
import argparse
import glob
import os

import cv2
import numpy as np

from classes import IGNORE, PERSON

# COCO's numbers of our classes: person, bottle, cup, chair, table, screen, laptop, mouse, keyboard, book
OURS = (0, 39, 41, 56, 60, 62, 63, 64, 66, 73)
COCO_PERSON, COCO_CLASSES = 0, 80
STRIDES = (8, 16, 32)         # of the detector's grids, px
SURE, SUSPECTED = 0.35, 0.08  # scores
MARGIN = 0.1                  # of a box's width and height: boxes of small networks cut off hands and feet
MIN_PEOPLE = 0.003            # share of the image: fewer pixels are no people
MIN_CONFIRMED = 0.7           # share of them inside sure boxes
BORDER_PX = 4                 # about a label that may be either
MIN_FILLED = 0.4              # of a box of a person, by its labels: bodies fill about half, and with less a part may be missing


class Detector:
    def __init__(self, path):
        try:
            import onnxruntime
        except ImportError as error:
            raise SystemExit(f'{error}: this needs `pip install onnxruntime`') from None
        options = onnxruntime.SessionOptions()
        options.intra_op_num_threads = 1
        self.session = onnxruntime.InferenceSession(path, options, providers=['CPUExecutionProvider'])
        self.input, (output, *_) = self.session.get_inputs()[0], self.session.get_outputs()
        self.side = self.input.shape[-1]
        cells = sum((self.side // s) ** 2 for s in STRIDES)
        if list(output.shape[1:]) != [cells, 5 + COCO_CLASSES]:
            raise SystemExit(f"'{path}' is no YOLOX of COCO: its output is {output.shape}, not 1x{cells}x{5 + COCO_CLASSES}")

    def __call__(self, image):
        """@param image  BGR  @return [(COCO class, score, (left, top), (right, bottom))], px"""
        scale = self.side / max(image.shape[:2])
        small = cv2.resize(image, None, fx=scale, fy=scale)[:self.side, :self.side]
        canvas = np.full((self.side, self.side, 3), 114, np.uint8)
        canvas[:small.shape[0], :small.shape[1]] = small
        found = self.session.run(None, {self.input.name: canvas.transpose(2, 0, 1)[None].astype(np.float32)})[0][0]
        return [(c, score, first / scale, last / scale) for c, score, first, last in decode(found, self.side)]


def decode(found, side):
    """Boxes of a YOLOX output (Ge et al. 2021): each cell of the three grids tells the offset of a centre from its corner and the
    logarithms of width and height, all in strides; then how sure it is of an object, and of each class.

    @param found  cells x (5 + classes)  @param side  of the input, px
    @return as Detector, in px of the input"""
    stride = np.concatenate([np.full((side // s) ** 2, s) for s in STRIDES])[:, None]
    cell = np.concatenate([np.stack(np.meshgrid(*2 * [np.arange(side // s)]), -1).reshape(-1, 2) for s in STRIDES])
    score = found[:, 4:5] * found[:, 5:]
    centre, half = (found[:, :2] + cell) * stride, np.exp(found[:, 2:4]) * stride / 2
    return [(score[i].argmax(), score[i].max(), centre[i] - half[i], centre[i] + half[i])
            for i in np.flatnonzero(score.max(axis=1) > SUSPECTED)]


def covered(boxes, shape, margin=0.0):
    """@return mask of `shape`, true inside the boxes"""
    mask = np.zeros(shape, bool)
    for _, _, first, last in boxes:
        border = margin * (last - first)
        left, top = np.maximum(0, first - border).astype(int)
        right, bottom = np.maximum(0, last + border).astype(int)
        mask[top:bottom, left:right] = True
    return mask


def is_filled(box, people):
    """@return whether it is a person's box, and the labels in it show a whole body"""
    inside = people[covered([box], people.shape)]
    return box[0] == COCO_PERSON and inside.size > 0 and inside.mean() >= MIN_FILLED


def second_opinion(label, boxes):
    """@param label  of the segmentation network, 255 where unknown  @return the corrected label, None if the two disagree"""
    sure = [box for box in boxes if box[0] == COCO_PERSON and box[1] > SURE]
    people = label == PERSON
    if people.mean() <= MIN_PEOPLE:
        if sure:
            return None
    elif (people & covered(sure, label.shape, MARGIN)).sum() < MIN_CONFIRMED * people.sum():
        return None
    known = ((label > 0) & (label != IGNORE)).astype(np.uint8)
    near = cv2.dilate(known, np.ones((2 * BORDER_PX + 1,) * 2, np.uint8)) > 0
    suspected = covered([box for box in boxes if box[0] in OURS and not is_filled(box, people)], label.shape)
    return np.where((label == IGNORE) & ~near & ~suspected, 0, label).astype(np.uint8)


def main(argv=None):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('detector')
    parser.add_argument('folder')
    args = parser.parse_args(argv)
    detector = Detector(args.detector)
    kept, images = 0, sorted(glob.glob(os.path.join(args.folder, 'images', '*')))
    if not images:
        raise SystemExit(f"'{args.folder}/images' holds no images; label_images writes them beside labels/")
    for path in images:
        label_path = os.path.join(args.folder, 'labels', os.path.splitext(os.path.basename(path))[0] + '.png')
        image, label = cv2.imread(path), cv2.imread(label_path, cv2.IMREAD_GRAYSCALE)
        if image is None or label is None or image.shape[:2] != label.shape:
            raise SystemExit(f"'{path}' and '{label_path}' do not load or differ in size")
        corrected = second_opinion(label, detector(image))
        if corrected is None:
            os.remove(path)
            os.remove(label_path)
        else:
            cv2.imwrite(label_path, corrected)
            kept += 1
    print(f'{kept} of {len(images)} photographs kept')


if __name__ == '__main__':
    main()

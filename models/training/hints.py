# SPDX-FileCopyrightText: 2026 The semantic_vslam authors
# SPDX-License-Identifier: BSD-3-Clause
"""Hints (Romero et al., "FitNets: Hints for Thin Deep Nets", ICLR 2015): what a ready network, the teacher, sees at every
place of an image, as a few numbers. To predict them teaches a network far more about a photograph than the labels do.

DIR/hints/STEM.npy holds them for DIR/images/STEM.jpg: rows x columns x HINTS, float16, the first and last row and column on
the image's border. Images without the file have none."""
import os

import cv2
import numpy as np

HINTS = 48   # numbers a place
STRIDE = 8   # px of a sample per place


def load(folder, stem):
    path = os.path.join(folder, 'hints', stem + '.npy')
    return np.load(path) if os.path.exists(path) else None


def none(size):
    """@param size  (width, height) of the sample, px  @return its hints where nothing is known: NaN"""
    return np.full((size[1] // STRIDE, size[0] // STRIDE, HINTS), np.nan, np.float32)


def of_sample(hints, shape, to_sample, size):
    """@param hints      of an image, of any float type, or None
    @param shape      rows and columns of the image
    @param to_sample  2x3, image px -> sample px
    @return rows/8 x columns/8 x HINTS at the places of the sample, NaN outside the image"""
    if hints is None:
        return none(size)
    rows, columns = hints.shape[:2]
    to_hints = np.diag([(columns - 1) / (shape[1] - 1), (rows - 1) / (shape[0] - 1), 1])
    place = np.array([[STRIDE, 0, STRIDE / 2 - 0.5], [0, STRIDE, STRIDE / 2 - 0.5], [0, 0, 1]])
    to_image = np.linalg.inv(np.vstack((to_sample, [0, 0, 1])))
    warp = (to_hints @ to_image @ place)[:2]
    grid = (size[0] // STRIDE, size[1] // STRIDE)
    options = {'flags': cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP}
    sampled = cv2.warpAffine(hints.astype(np.float32), warp, grid, borderMode=cv2.BORDER_REPLICATE, **options)
    inside = cv2.warpAffine(np.ones((rows, columns), np.float32), warp, grid, **options)
    sampled[inside < 0.99] = np.nan
    return sampled

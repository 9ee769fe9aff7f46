#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The semantic_vslam authors
# SPDX-License-Identifier: BSD-3-Clause
"""Labels a TUM sequence of a room in which nothing but people moves, from outlines drawn in a few of its frames.

usage: label_sequence.py SEQUENCE OBJECTS.yaml OUT [--people LABELS] [--every 1]

OBJECTS.yaml lists flat outlines ({frame, label, outline: [[u, v], ...] in px}), the camera and a table top ({frame, outline}).
Every outline is laid on the plane through its depths and carried to every frame by the true poses, the far ones first.
Other places on the table top's plane are table, above it clutter, all others background; without depth they are unknown. LABELS is
a folder of label images by a network that knows people and chairs; what it names those outside the outlines becomes that,
and where it names another thing there, the truth is taken as unknown. OUT gets images/, labels/ and depth/, as train.py
reads them.
"""
import argparse
import os
import shutil

import cv2
import numpy as np
import yaml

from classes import IGNORE, NAMES

TABLE_BAND = 0.015     # of the squared depth in m: three sigma of a Kinect's noise
CLUTTER_BAND = 0.03    # nearer to the plane than this, neither table nor clutter is sure
MIN_DEPTHS = 30        # of an outline, to lay a plane through
BY_PEOPLE_NETWORK = ('person', 'chair')


class Sequence:
    def __init__(self, folder, camera):
        self.folder = folder
        fx, fy, cx, cy = camera['intrinsics']
        self.k = np.array([[fx, 0, cx], [0, fy, cy], [0, 0, 1]])
        self.distortion = np.array(camera['distortion'], np.float64)
        with open(os.path.join(folder, 'associations.txt'), encoding='utf-8') as text:
            rows = [line.split() for line in text if not line.startswith('#')]
        self.frames = {row[1]: (float(row[0]), row[3]) for row in rows}  # colour path -> stamp, depth path
        self.truth = np.loadtxt(os.path.join(folder, 'groundtruth.txt'))

    def pose(self, frame):
        """@return T_world_camera, 4x4, of the nearest stamp of the motion capture (100 Hz)."""
        stamp, _ = self.frames[frame]
        _, x, y, z, qx, qy, qz, qw = self.truth[np.abs(self.truth[:, 0] - stamp).argmin()]
        pose = np.eye(4)
        q = np.array([qx, qy, qz])
        cross = np.array([[0, -qz, qy], [qz, 0, -qx], [-qy, qx, 0]])
        pose[:3, :3] = (qw * qw - q @ q) * np.eye(3) + 2 * np.outer(q, q) + 2 * qw * cross
        pose[:3, 3] = x, y, z
        return pose

    def rays(self, pixels):
        """@param pixels  N x 2  @return N x 3, z = 1"""
        flat = cv2.undistortPoints(np.float64(pixels).reshape(-1, 1, 2), self.k, self.distortion)[:, 0]
        return np.column_stack((flat, np.ones(len(flat))))

    def depth_m(self, frame):
        depth = cv2.imread(os.path.join(self.folder, self.frames[frame][1]), cv2.IMREAD_UNCHANGED)
        return depth.astype(np.float64) / 5000

    def points(self, frame, mask):
        """@return world points, N x 3, and their pixels, N x 2, where the mask is set and there is depth."""
        depth_m = self.depth_m(frame)
        v, u = np.nonzero((depth_m > 0) & (mask > 0))
        camera = self.rays(np.column_stack((u, v))) * depth_m[v, u, None]
        pose = self.pose(frame)
        return camera @ pose[:3, :3].T + pose[:3, 3], np.column_stack((u, v))

    def project(self, world, frame):
        """@return pixels N x 2 and depths N"""
        pose = self.pose(frame)
        camera = (world - pose[:3, 3]) @ pose[:3, :3]
        pixels, _ = cv2.projectPoints(camera.reshape(-1, 1, 3), np.zeros(3), np.zeros(3), self.k, self.distortion)
        return pixels[:, 0], camera[:, 2]


def fit_plane(points, rng, band_m=0.01, trials=200):
    """@return unit normal and offset of the plane n x = d that most points lie on"""
    best = None
    for _ in range(trials):
        a, b, c = points[rng.choice(len(points), 3, replace=False)]
        n = np.cross(b - a, c - a)
        if np.linalg.norm(n) < 1e-9:
            continue
        n /= np.linalg.norm(n)
        near = np.abs(points @ n - n @ a) < band_m
        if best is None or near.sum() > best.sum():
            best = near
    centre = points[best].mean(axis=0)
    n = np.linalg.svd(points[best] - centre, full_matrices=False)[2][2]
    return n, n @ centre


def outline_mask(outline, shape):
    return cv2.fillPoly(np.zeros(shape, np.uint8), [np.int32(outline)], 1)


def lift(sequence, frame, outline, rng):
    """@return the outline's corners in the world, N x 3, on the plane through its depths"""
    shape = sequence.depth_m(frame).shape
    points, _ = sequence.points(frame, outline_mask(outline, shape))
    if len(points) < MIN_DEPTHS:
        raise SystemExit(f'{frame}: the outline that starts at {outline[0]} has only {len(points)} depths')
    n, d = fit_plane(points, rng)
    pose = sequence.pose(frame)
    rays = sequence.rays(outline) @ pose[:3, :3].T
    return pose[:3, 3] + rays * ((d - n @ pose[:3, 3]) / (rays @ n))[:, None]


def table_labels(sequence, frame, plane):
    """@param plane  normal and offset  @return label image"""
    shape = sequence.depth_m(frame).shape
    labels = np.full(shape, IGNORE, np.uint8)
    points, pixels = sequence.points(frame, np.ones(shape, np.uint8))
    squared_depth = sequence.depth_m(frame)[pixels[:, 1], pixels[:, 0]] ** 2
    height = np.abs(points @ plane[0] - plane[1]) / squared_depth
    values = np.zeros(len(points), np.uint8)
    values[height < CLUTTER_BAND] = IGNORE
    values[height < TABLE_BAND] = NAMES.index('table')
    labels[pixels[:, 1], pixels[:, 0]] = values
    return labels


def by_network(labels, named):
    """Takes people and chairs from a network's label image."""
    table = labels == NAMES.index('table')
    for c in range(1, len(NAMES)):
        labels[(named == c) & ~table] = c if NAMES[c] in BY_PEOPLE_NETWORK else IGNORE


def paint(sequence, frame, labels, objects):
    """Fills the outlines, the far ones first."""
    projected = [(*sequence.project(corners, frame), label) for corners, label in objects]
    for pixels, depths, label in sorted(projected, key=lambda o: -o[1].mean()):
        if depths.min() > 0.1:
            cv2.fillPoly(labels, [np.int32(pixels.round())], label)


def main(argv=None):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('sequence')
    parser.add_argument('objects')
    parser.add_argument('out')
    parser.add_argument('--people', help='folder of label images, STEM.png; frames without one are left out')
    parser.add_argument('--every', type=int, default=1, help='takes every so many-th frame')
    args = parser.parse_args(argv)
    with open(args.objects, encoding='utf-8') as text:
        scene = yaml.safe_load(text)
    sequence, rng = Sequence(args.sequence, scene['camera']), np.random.default_rng(1)
    objects = [(lift(sequence, o['frame'], o['outline'], rng), NAMES.index(o['label'])) for o in scene['objects']]
    top, shape = scene['table'], sequence.depth_m(scene['table']['frame']).shape
    plane = fit_plane(sequence.points(top['frame'], outline_mask(top['outline'], shape))[0], rng)
    for folder in ('images', 'labels', 'depth'):
        os.makedirs(os.path.join(args.out, folder), exist_ok=True)
    for frame in list(sequence.frames)[::args.every]:
        stem = os.path.splitext(os.path.basename(frame))[0]
        by_people = os.path.join(args.people, stem + '.png') if args.people else None
        if by_people and not os.path.exists(by_people):
            continue
        labels = table_labels(sequence, frame, plane)
        if by_people:
            by_network(labels, cv2.imread(by_people, cv2.IMREAD_GRAYSCALE))
        paint(sequence, frame, labels, objects)
        shutil.copy(os.path.join(args.sequence, frame), os.path.join(args.out, 'images'))
        shutil.copy(os.path.join(args.sequence, sequence.frames[frame][1]), os.path.join(args.out, 'depth', stem + '.png'))
        cv2.imwrite(os.path.join(args.out, 'labels', stem + '.png'), labels)


if __name__ == '__main__':
    main()

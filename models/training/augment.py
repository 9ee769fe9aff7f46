# SPDX-FileCopyrightText: 2026 The semantic_vslam authors
# SPDX-License-Identifier: BSD-3-Clause
"""Augmentation. Images are HxWx3 uint8 RGB, labels HxW uint8; every draw comes from the generator that is passed in.

How much is a matter of measurement: a network this small learns less from samples that are all distorted (README.md)."""
import cv2
import numpy as np

from classes import IGNORE, NAMES, PERSON

PASTED = tuple(NAMES.index(name) for name in
               ('person', 'chair', 'monitor', 'keyboard', 'mouse', 'book', 'laptop', 'bottle', 'cup'))
PHOTOMETRIC = 0.5        # share of samples whose light and sharpness are changed
PERSON_ODDS = 0.6        # of a paste; the other classes share the rest
MIN_CUTOUT_PX = 400      # smaller ones show too little of the object
MIN_CUTOUT_SHARE = 0.35  # of its box: scattered pieces are no object
MAX_CUTOUTS = 400        # a source and class; enough to vary, and bounded in memory
NEAR = 0.6               # of the people pasted: so near that the image shows a part of the body
BEHIND = 0.6             # of what is pasted where depth is known: behind what is nearer than some distance
MAX_ENLARGED = 6.0       # times, of a cutout: smooth then, as what moves close before a camera
SMOOTH = 0.5             # of the near people: out of focus or moving, blurred by up to MAX_SMOOTH of the sample's width
MAX_SMOOTH = 0.006


def crop(image, label, size, rng):
    """A random part, 40 % to 120 % of the image, its aspect ratio changed by up to 20 %, perhaps mirrored.

    @return image and label of `size` (width, height), and the 2x3 transformation from px of the image to px of the part"""
    width, height = size
    h, w = label.shape
    scale = np.exp(rng.uniform(np.log(0.4), np.log(1.2))) * min(w / width, h / height)
    aspect = np.exp(rng.uniform(-0.2, 0.2))
    part_w, part_h = width * scale * aspect, height * scale / aspect
    x = rng.uniform(min(0, w - part_w), max(0, w - part_w))
    y = rng.uniform(min(0, h - part_h), max(0, h - part_h))
    to_part = np.float32([[width / part_w, 0, -x * width / part_w], [0, height / part_h, -y * height / part_h]])
    if rng.random() < 0.5:
        to_part = np.float32([[-1, 0, width - 1], [0, 1, 0]]) @ np.vstack((to_part, [0, 0, 1])).astype(np.float32)
    if scale > 1.5:  # warpAffine does not average
        image = cv2.GaussianBlur(image, (0, 0), 0.4 * scale)
    image = cv2.warpAffine(image, to_part, size, flags=cv2.INTER_LINEAR, borderMode=cv2.BORDER_REFLECT_101)
    label = cv2.warpAffine(label, to_part, size, flags=cv2.INTER_NEAREST, borderValue=IGNORE)
    return image, label, to_part


def photometric(image, rng):
    """Light, contrast, white balance, saturation, gamma, blur, noise and JPEG, as cheap cameras give them."""
    x = relight(image, rng)
    if rng.random() < 0.3:
        x = cv2.GaussianBlur(x, (0, 0), rng.uniform(0.4, 1.6))
    if rng.random() < 0.15:
        x = _motion_blur(x, rng)
    if rng.random() < 0.5:
        x += rng.uniform(0.005, 0.04) * rng.standard_normal(x.shape, np.float32)
    image = cv2.convertScaleAbs(np.maximum(x, 0, out=x), alpha=255)
    if rng.random() < 0.3:
        _, data = cv2.imencode('.jpg', image, [cv2.IMWRITE_JPEG_QUALITY, int(rng.integers(30, 95))])
        image = cv2.imdecode(data, cv2.IMREAD_COLOR)
    return image


def relight(image, rng):
    """Light, contrast, white balance, saturation and gamma. @return float32, 0 to 1 and a little beyond"""
    levels = np.linspace(0, 1, 256, dtype=np.float32)[:, None] ** np.exp(rng.uniform(-0.4, 0.4))
    x = cv2.LUT(image, (levels * np.exp(rng.uniform(-0.15, 0.15, 3)))[None].astype(np.float32))
    saturation, contrast = rng.uniform(0.4, 1.4), rng.uniform(0.7, 1.3)
    mix = contrast * (saturation * np.eye(3) + (1 - saturation) / 3)  # saturation about each pixel's grey,
    lift = (1 - contrast) * np.mean(cv2.mean(x)[:3]) + rng.uniform(-0.12, 0.12)  # contrast about the image's
    return cv2.transform(x, np.hstack((mix, np.full((3, 1), lift))))


def _motion_blur(x, rng):
    length = int(rng.integers(3, 12))
    kernel = np.zeros((length, length), np.float32)
    angle = rng.uniform(0, np.pi)
    centre = (length - 1) / 2
    end = (centre * np.cos(angle), centre * np.sin(angle))
    cv2.line(kernel, (round(centre - end[0]), round(centre - end[1])), (round(centre + end[0]), round(centre + end[1])), 1)
    return cv2.filter2D(x, -1, kernel / kernel.sum())


class Cutouts:
    """Objects cut from the training images by their masks, to be pasted into others."""

    def __init__(self, sources):
        self.by_class = {c: [] for c in PASTED}
        for source in sources:
            room = {c: MAX_CUTOUTS for c in PASTED}
            for index in np.random.default_rng(len(source)).permutation(len(source)):
                if not any(room.values()):
                    break
                self._collect(source.load(index), room)
        self.by_class = {c: cutouts for c, cutouts in self.by_class.items() if cutouts}

    def _collect(self, labelled, room):
        image, label, _ = labelled
        for c in PASTED:
            if not room[c] or not (label == c).any():
                continue
            count, parts, stats, _ = cv2.connectedComponentsWithStats((label == c).astype(np.uint8))
            for k in range(1, count):
                x, y, w, h, area = stats[k]
                if room[c] and area >= MIN_CUTOUT_PX and area >= MIN_CUTOUT_SHARE * w * h:
                    inside = (slice(y, y + h), slice(x, x + w))
                    mask = (parts[inside] == k).astype(np.uint8)
                    self.by_class[c].append(Cutout(c, image[inside].copy(), mask))
                    room[c] -= 1

    def paste(self, image, label, depth, rng):
        """Puts one to three cutouts in. People at any size, up to a body so near that the image shows only a part; where there
        is a depth image, behind what is nearer: people walk behind desks and screens too. @return image, label"""
        if not self.by_class:
            return image, label
        depth = None if depth is None else depth.copy()
        for _ in range(rng.integers(1, 4)):
            others = [c for c in self.by_class if c != PERSON]
            person = PERSON in self.by_class and (not others or rng.random() < PERSON_ODDS)
            c = PERSON if person else others[rng.integers(len(others))]
            cutout = self.by_class[c][rng.integers(len(self.by_class[c]))]
            image, label = cutout.paste(image, label, depth, rng)
        return image, label


class Cutout:
    def __init__(self, label, patch, mask):
        """@param patch  rows x columns x 3, RGB  @param mask  rows x columns uint8, 1 where it shows the object"""
        self.label, self.patch, self.mask = label, patch, mask

    def paste(self, image, label, depth, rng):
        """@param depth  HxW uint16, 0 where unknown, which gets the cutout's; or None  @return image, label"""
        size = (label.shape[1], label.shape[0])
        warp, near = self._transformation(size, rng)
        alpha = cv2.warpAffine(self.mask.astype(np.float32), warp, size)
        if depth is not None:
            _hide(alpha, depth, rng)
        patch = relight(cv2.warpAffine(self.patch, warp, size, borderMode=cv2.BORDER_REFLECT_101), rng) * np.float32(255)
        if near and rng.random() < SMOOTH:
            patch = cv2.GaussianBlur(patch, (0, 0), max(0.3, rng.uniform(0, MAX_SMOOTH) * size[0]))
        soft = cv2.GaussianBlur(alpha, (0, 0), rng.uniform(0.5, 1.2))[..., None]
        image = np.clip(image + (patch - image) * soft, 0, 255).astype(np.uint8)
        label = np.where(alpha > 0.5, np.uint8(self.label), label)
        return image, label

    def _transformation(self, size, rng):
        """@return 2x3, px of the patch -> px of the sample; whether it is a person so near that a part is seen"""
        person = self.label == PERSON
        rows, columns = self.mask.shape
        angle = rng.uniform(-10, 10) if person else rng.uniform(-25, 25)
        to = (rng.uniform(0, size[0]), rng.uniform(0.2, 1.0) * size[1])
        centre = (columns / 2, rows / 2)
        near = person and rng.random() < NEAR
        if near:
            scale = min(MAX_ENLARGED, rng.uniform(0.3, 0.8) * size[0] / columns)
            centre, to = (columns / 2, rng.uniform(0.2, 0.9) * rows), (to[0], size[1] / 2)
        else:
            share = np.exp(rng.uniform(np.log(0.3), np.log(2.0)) if person else rng.uniform(np.log(0.08), np.log(0.6)))
            scale = share * size[1] / max(rows, 0.7 * columns)
        warp = cv2.getRotationMatrix2D(centre, angle, scale)
        warp[:, 2] += (to[0] - centre[0], to[1] - centre[1])
        if rng.random() < 0.5:
            warp = warp @ np.array([[-1, 0, columns - 1], [0, 1, 0], [0, 0, 1.0]])
        return warp, near


def _hide(alpha, depth, rng):
    """Sets a cutout at some distance: what is nearer hides it. Both images are written to."""
    known = depth[(alpha > 0.5) & (depth > 0)]
    distance = 1  # nearer than all
    if known.size and rng.random() < BEHIND:
        distance = np.quantile(known, rng.uniform(0.2, 1.0))
        alpha[(depth > 0) & (depth < distance)] = 0
    depth[alpha > 0.5] = distance

# SPDX-FileCopyrightText: 2026 The semantic_vslam authors
# SPDX-License-Identifier: BSD-3-Clause
"""Labelled images from folders, and endless augmented samples of them."""
import glob
import os
import re
import typing
import zlib

import cv2
import numpy as np
import torch

import augment
from classes import PERSON, label_of_coco

IMAGE_FOLDERS = ('rgb', 'images')
FOLD = 5  # every fifth image, by a hash of its name, is held back from training
KEPT_BYTES = 2**28  # of a folder's decoded images in memory: to decode one takes longer than all that is done to it


class LabelledImage(typing.NamedTuple):
    """Not to be written to: a folder keeps it."""
    image: np.ndarray           # HxWx3 uint8, RGB
    label: np.ndarray           # HxW uint8
    depth: typing.Optional[np.ndarray]  # HxW uint16, of any unit; 0: unknown


class LabelledFolder:
    """Images and label images of the same stem.

    DIR/rgb or DIR/images, and DIR/labels (8-bit PNG, our class ids, 255 = ignore) or DIR/masks with DIR/config.yaml
    (COCO panoptic ids and their names). make_synthetic_bag --tum and label_images write the first form. And depth, where
    DIR/depth has a 16-bit PNG of the same stem.
    """

    def __init__(self, folder):
        self.folder = folder
        images = next((os.path.join(folder, d) for d in IMAGE_FOLDERS if os.path.isdir(os.path.join(folder, d))), None)
        coco = os.path.isdir(os.path.join(folder, 'masks')) and not os.path.isdir(os.path.join(folder, 'labels'))
        labels = os.path.join(folder, 'masks' if coco else 'labels')
        if images is None or not os.path.isdir(labels):
            raise SystemExit(f"'{folder}' is no labelled folder: it needs rgb/ or images/, and labels/ or masks/")
        self.table = _coco_table(folder) if coco else None
        self.kept, self.room = {}, KEPT_BYTES  # by path of the image
        self.pairs = []
        for path in sorted(glob.glob(os.path.join(images, '*'))):
            label = os.path.join(labels, os.path.splitext(os.path.basename(path))[0] + '.png')
            if os.path.exists(label):
                self.pairs.append((path, label))
        if not self.pairs:
            raise SystemExit(f"'{folder}' holds no image with a label image of the same name")

    def split(self, held_back):
        """@return self, with the held-back fold alone or all but it."""
        self.pairs = [p for p in self.pairs if is_held_back(p[0]) == held_back]
        return self

    def first(self, count):
        """@return self, with no more than `count` images, spread evenly."""
        self.pairs = self.pairs[::max(1, -(-len(self.pairs) // count))]
        return self

    def __len__(self):
        return len(self.pairs)

    def load(self, index):
        """@return the LabelledImage"""
        path, label_path = self.pairs[index]
        if path not in self.kept:
            loaded = self._decode(path, label_path)
            size = sum(array.nbytes for array in loaded if array is not None)
            if size > self.room:
                return loaded
            self.room -= size
            self.kept[path] = loaded
        return self.kept[path]

    def _decode(self, path, label_path):
        image, label = cv2.imread(path, cv2.IMREAD_COLOR), cv2.imread(label_path, cv2.IMREAD_GRAYSCALE)
        if image is None or label is None or image.shape[:2] != label.shape:
            raise SystemExit(f"'{path}' and '{label_path}' do not load or differ in size")
        if self.table is not None:
            label = self.table[label]
        stem = os.path.splitext(os.path.basename(path))[0]
        return LabelledImage(cv2.cvtColor(image, cv2.COLOR_BGR2RGB), label, self._depth(stem, label.shape))

    def _depth(self, stem, shape):
        path = os.path.join(self.folder, 'depth', stem + '.png')
        if not os.path.exists(path):
            return None
        depth = cv2.imread(path, cv2.IMREAD_UNCHANGED)
        if depth is None or depth.dtype != np.uint16 or depth.shape != shape:
            raise SystemExit(f"'{path}' does not load, or is no 16-bit image of the size of its labels")
        return depth


def is_held_back(path):
    stem = os.path.splitext(os.path.basename(path))[0]
    return zlib.crc32(stem.encode()) % FOLD == 0


def _coco_table(folder):
    path = os.path.join(folder, 'config.yaml')
    with open(path, encoding='utf-8') as text:
        names = {int(i): name.strip() for i, name in re.findall(r'^\s+(\d+):\s*(\S.*)$', text.read(), re.MULTILINE)}
    if not names:
        raise SystemExit(f"'{path}' lists no classes")
    return np.array(label_of_coco(names), np.uint8)


class AugmentedSamples(torch.utils.data.Dataset):
    """Sample `index` is the same whenever it is asked for, so that a resumed run goes on exactly where it stopped.

    @param sources  [(LabelledFolder, weight)]: how often each is drawn from
    @param sizes    [(width, height)] of samples, px, which take turns
    @param count    samples in all
    @param paste    share that cutouts are pasted into; twice it of the parts without people
    @param turn     samples of one size before the next size's
    """

    def __init__(self, sources, sizes, count, seed=1, paste=0.5, turn=1):
        self.sources = [folder for folder, _ in sources]
        weights = np.array([weight for _, weight in sources], float)
        self.odds = weights / weights.sum()
        self.sizes, self.count, self.seed, self.paste, self.turn = sizes, count, seed, paste, turn
        self.cutouts = augment.Cutouts(self.sources)

    def __len__(self):
        return self.count

    def __getitem__(self, index):
        rng = np.random.default_rng((self.seed, index))
        size = self.sizes[index // self.turn % len(self.sizes)]
        source = self.sources[rng.choice(len(self.sources), p=self.odds)]
        whole = source.load(rng.integers(len(source)))
        image, label, to_sample = augment.crop(whole.image, whole.label, size, rng)
        if rng.random() < (self.paste if (label == PERSON).any() else 2 * self.paste):
            depth = whole.depth
            if depth is not None:
                depth = cv2.warpAffine(depth, to_sample, size, flags=cv2.INTER_NEAREST)
            image, label = self.cutouts.paste(image, label, depth, rng)
        if rng.random() < augment.PHOTOMETRIC:
            image = augment.photometric(image, rng)
        return planar(image), torch.from_numpy(label)


def planar(image):
    return torch.from_numpy(np.ascontiguousarray(image.transpose(2, 0, 1)))


def resized(image, label, size):
    """What the network sees at run time: the whole image stretched to its input. The label keeps its own size."""
    shrink = image.shape[1] >= 2 * size[0] and image.shape[0] >= 2 * size[1]
    image = cv2.resize(image, size, interpolation=cv2.INTER_AREA if shrink else cv2.INTER_LINEAR)
    return planar(image), label

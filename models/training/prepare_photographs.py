#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The semantic_vslam authors
# SPDX-License-Identifier: BSD-3-Clause
"""Makes labelled folders for train.py out of public repositories of photographs with masks, and of rooms that nobody is in.

usage: prepare_photographs.py CLONES OUT --segmenter deeplabv3_mnv2_pascal_quant.onnx --detector yolox_nano.onnx [--sets voc ...]

CLONES holds a bare or plain clone of each, as OWNER+NAME or OWNER+NAME/repo (README.md lists them; those of --sets are needed). OUT
gets a folder for each set: voc, coco, clothes, rooms, furniture; and voc_people and voc_furnished, so that they can be drawn more often. What a set's own labels leave open is unknown (255) where one of the
two ready networks suspects one of our classes, and background elsewhere; images held back keep their true labels where they have some.
Needs the Python packages onnxruntime, Pillow for voc, and SciPy for clothes.
"""
import argparse
import collections
import io
import json
import os
import re
import subprocess
import zlib

import cv2
import numpy as np

from classes import COCO_ALIASES, IGNORE, NAMES, PERSON
from dataset import is_held_back
from second_opinion import COCO_PERSON, OURS, SURE, Detector, covered, is_filled

VOC_MASKS = 'zzq96+Nested-unet', '57e85f684455450631906bae1dd6016c58edac04'
VOC_PHOTOGRAPHS = 'mateusrafael4+Atividade_programacao_pose_estimation', 'HEAD'
COCO = ('Obmutescence+COCO-MINI', 'HEAD'), ('zzowenzz+COCO_Tiny', 'HEAD')
CLOTHES = 'bearpaw+clothing-co-parsing', 'HEAD'
ROOMS = 'emanhamed+Houses-dataset', 'HEAD'
FURNITURE = 'maher-mohsen+Furniture-Segmentation', 'HEAD'

VOC_CLASSES = {5: 'bottle', 9: 'chair', 11: 'table', 15: 'person', 20: 'monitor'}  # all others are background
NO_BODY = (2, 33, 56)       # of the clothes' labels: bag, purse, wallet
FURNITURE_CLASSES = (None, 'chair', None, None, 'chair', 'table')  # bed, chair, plant, sofa, swivel chair, table
OUTLINED = 0.6              # shared by two boxes, of what either covers
FURNITURE_STEP = 3          # takes every third image: more would outnumber all the rest
COCO_TABLE, COCO_CHAIR = 60, 56  # the detector's numbers
COCO_JUDGED = {'000000000139', '000000000802', '000000005001', '000000010764', '000000011813'}  # other tests judge by these
MAX_SIDE = 640              # px, of what is written
SHAPES = ((640, 480), (560, 560), (480, 640))  # what furniture's squares may have been before they were stretched


class Clone:
    """Files of a repository's commit, read without a work tree."""

    def __init__(self, clones, name, commit):
        paths = [os.path.join(clones, name, *rest) for rest in (('repo',), ('.git',), ())]
        self.git = ['git', '--git-dir', next((p for p in paths if os.path.exists(os.path.join(p, 'HEAD'))), paths[-1])]
        try:
            listed = subprocess.run(self.git + ['ls-tree', '-rz', commit], capture_output=True, check=True).stdout
        except subprocess.CalledProcessError as error:
            raise SystemExit(f"'{os.path.join(clones, name)}' is no clone with {commit}: {error.stderr.decode().strip()}") from None
        rows = (row.split('\t', 1) for row in listed.decode().split('\0') if row)
        self.blobs = {path: entry.split()[2] for entry, path in rows}
        self.reader = subprocess.Popen(self.git + ['cat-file', '--batch'], stdin=subprocess.PIPE, stdout=subprocess.PIPE)

    def paths(self, pattern):
        """@return [(path, match)], sorted, of the files whose whole path the pattern matches"""
        return [(p, m) for p, m in ((p, re.fullmatch(pattern, p)) for p in sorted(self.blobs)) if m]

    def read(self, path):
        self.reader.stdin.write(self.blobs[path].encode() + b'\n')
        self.reader.stdin.flush()
        header = self.reader.stdout.readline().split()
        if header[-1] == b'missing':
            raise SystemExit(f"'{path}' is missing in the clone")
        return self.reader.stdout.read(int(header[2]) + 1)[:-1]

    def image(self, path, flags=cv2.IMREAD_COLOR):
        """@return None where the file is no image"""
        return cv2.imdecode(np.frombuffer(self.read(path), np.uint8), flags)

    def close(self):
        self.reader.stdin.close()
        self.reader.stdout.close()
        self.reader.wait()


class Segmenter:
    """DeepLab of Pascal VOC's classes: bytes in, labels out."""

    def __init__(self, path):
        import onnxruntime
        options = onnxruntime.SessionOptions()
        options.intra_op_num_threads = 1
        self.session = onnxruntime.InferenceSession(path, options, providers=['CPUExecutionProvider'])
        self.input = self.session.get_inputs()[0]

    def __call__(self, image):
        """@param image  BGR  @return label image of our classes"""
        _, rows, columns, _ = self.input.shape
        small = cv2.cvtColor(cv2.resize(image, (columns, rows), interpolation=cv2.INTER_AREA), cv2.COLOR_BGR2RGB)
        found = np.squeeze(self.session.run(None, {self.input.name: small[None]})[0]).astype(np.uint8)
        return cv2.resize(table_of_voc()[found], image.shape[1::-1], interpolation=cv2.INTER_NEAREST)


def table_of_voc():
    """@return 256 entries: VOC's id -> ours"""
    table = np.zeros(256, np.uint8)
    for voc, name in VOC_CLASSES.items():
        table[voc] = NAMES.index(name)
    table[255] = IGNORE
    return table


def unnamed(label, boxes, named):
    """@param boxes  of the detector  @param named  COCO's numbers of the classes that the label image tells apart
    @return the label image, its background unknown where the detector suspects one of the other classes"""
    suspected = covered([box for box in boxes if box[0] in OURS and box[0] not in named], label.shape)
    return np.where((label == 0) & suspected, IGNORE, label).astype(np.uint8)


def two_opinions(label, segmented, boxes, people=True):
    """Fills what is unknown: background where neither network sees one of our classes.

    @param label  255 where unknown  @param people  whether there may be some that are not labelled; all that the networks call a person
    is background otherwise"""
    seen = (segmented > 0) & ((segmented != PERSON) | people)
    boxes = [box for box in boxes if box[0] in OURS and (box[0] != COCO_PERSON or (people and box[1] > SURE))]
    return np.where((label == IGNORE) & ~seen & ~covered(boxes, label.shape), 0, label).astype(np.uint8)


def is_outlined(box, labelled):
    """@return whether a box of the detector is about that of what is labelled: it tells nothing more then"""
    rows, columns = np.flatnonzero(labelled.any(axis=1)), np.flatnonzero(labelled.any(axis=0))
    if not rows.size:
        return False
    first, last = np.array((columns[0], rows[0])), np.array((columns[-1], rows[-1])) + 1
    shared = np.prod(np.maximum(0, np.minimum(last, box[3]) - np.maximum(first, box[2])))
    return shared > OUTLINED * (np.prod(last - first) + np.prod(box[3] - box[2]) - shared)


def agreed(segmented, boxes):
    """@return label image of furniture that both networks see, 255 elsewhere"""
    label = np.full(segmented.shape, IGNORE, np.uint8)
    for name, number in (('chair', COCO_CHAIR), ('table', COCO_TABLE), ('monitor', 62)):
        sure = covered([box for box in boxes if box[0] == number and box[1] > SURE], label.shape)
        label[(segmented == NAMES.index(name)) & sure] = NAMES.index(name)
    return label


def voc(clones, _, detector):
    """True masks of Pascal VOC's classes (those of SBD and VOC 2012)."""
    masks, photographs = Clone(clones, *VOC_MASKS), Clone(clones, *VOC_PHOTOGRAPHS)
    for path, match in photographs.paths(r'images/(\w+)\.jpg'):
        mask = f'SegmentationClassAug/{match[1]}.png'
        if mask not in masks.blobs:
            continue
        image, label = photographs.image(path), palette_indices(masks.read(mask))
        if image is None or image.shape[:2] != label.shape:
            continue
        label = table_of_voc()[label]
        if not is_held_back(match[1]):  # VOC knows no cups, books, laptops, and dining tables alone
            label = unnamed(label, detector(image), (0, 39, 56, 62))
        yield match[1], image, label
    masks.close()
    photographs.close()


def palette_indices(content):
    """@return the indices of a PNG with a palette, which OpenCV only gives as colours"""
    from PIL import Image
    return np.array(Image.open(io.BytesIO(content)))


def coco(clones, _, detector):
    """Polygons of COCO's 80 things; a desk is none of them."""
    for name, commit in COCO:
        clone = Clone(clones, name, commit)
        for fold in ('train2017', 'val2017'):
            annotations = json.loads(clone.read(f'annotations/instances_{fold}.json'))
            classes = {c['id']: COCO_ALIASES.get(c['name'], c['name']) for c in annotations['categories']}
            of_image = collections.defaultdict(list)
            for annotation in annotations['annotations']:
                of_image[annotation['image_id']].append(annotation)
            for entry in annotations['images']:
                stem, path = os.path.splitext(entry['file_name'])[0], f"{fold}/{entry['file_name']}"
                if stem in COCO_JUDGED or path not in clone.blobs:
                    continue
                image = clone.image(path)
                label = draw_instances(image.shape[:2], of_image[entry['id']], classes)
                if not is_held_back(stem):
                    label = unnamed(label, [box for box in detector(image) if box[0] == COCO_TABLE], ())
                yield stem, image, label
        clone.close()


def draw_instances(shape, annotations, classes):
    """@param annotations  of one image, as COCO's files have them  @param classes  {COCO's id: name}  @return label image"""
    label = np.zeros(shape, np.uint8)
    drawn = np.zeros(shape, np.uint8)
    for annotation in sorted(annotations, key=lambda a: -a['area']):  # the small ones are on top
        if not annotation.get('iscrowd'):
            name = classes[annotation['category_id']]
            polygons = [np.float32(p).reshape(-1, 2).round().astype(np.int32) for p in annotation['segmentation']]
            cv2.fillPoly(label, polygons, NAMES.index(name) if name in NAMES else 0)
            cv2.fillPoly(drawn, polygons, 1)
    for annotation in annotations:
        if annotation.get('iscrowd') and classes[annotation['category_id']] in NAMES:
            x, y, w, h = (int(round(v)) for v in annotation['bbox'])
            inside = np.s_[y:y + h, x:x + w]
            label[inside][drawn[inside] == 0] = IGNORE
    return label


def clothes(clones, segmenter, detector):
    """Whole people with exact outlines; whoever passes by is not labelled."""
    from scipy.io import loadmat
    clone = Clone(clones, *CLOTHES)
    for path, match in clone.paths(r'annotations/pixel-level/(\w+)\.mat'):
        image = clone.image(f'photos/{match[1]}.jpg')
        garments = loadmat(io.BytesIO(clone.read(path)))['groundtruth']
        if image is None or image.shape[:2] != garments.shape:
            continue
        label = np.where((garments > 0) & ~np.isin(garments, NO_BODY), np.uint8(PERSON), np.uint8(IGNORE))
        around = cv2.dilate(np.uint8(label == PERSON), np.ones((9, 9), np.uint8)) > 0  # what the outline leaves out is near it
        boxes = [box for box in detector(image) if not is_filled(box, label == PERSON)]
        filled = two_opinions(label, segmenter(image), boxes)
        yield match[1], image, np.where(around & (label == IGNORE), IGNORE, filled).astype(np.uint8)
    clone.close()


def rooms(clones, segmenter, detector):
    """Kitchens, bedrooms and bathrooms that nobody is in, without labels."""
    clone = Clone(clones, *ROOMS)
    for path, match in clone.paths(r'Houses Dataset/(\d+_(?:kitchen|bedroom|bathroom))\.jpg'):
        image = clone.image(path)
        if image is not None:
            image = smaller(image)
            segmented, boxes = segmenter(image), detector(image)
            yield match[1], image, two_opinions(agreed(segmented, boxes), segmented, boxes, people=False)
    clone.close()


def furniture(clones, segmenter, detector):
    """One piece of furniture has an outline; others stand there unlabelled."""
    clone = Clone(clones, *FURNITURE)
    paths = clone.paths(r'Data/(?:train|valid|test)/images/(img\d+)_jpg\.rf\.(\w+)\.jpg')  # others bear a shop's numbers
    for path, match in paths[::FURNITURE_STEP]:
        image = clone.image(path)
        rows = [line.split() for line in clone.read(path.replace('/images/', '/labels/')[:-3] + 'txt').decode().splitlines()]
        if image is None or not rows:
            continue
        stem = f'{match[1]}-{match[2][:8]}'
        size = SHAPES[zlib.crc32(match[2].encode()) % len(SHAPES)]
        image = cv2.resize(image, size, interpolation=cv2.INTER_AREA)
        label = np.full(image.shape[:2], IGNORE, np.uint8)
        for row in rows:
            name = FURNITURE_CLASSES[int(row[0])]
            polygon = (np.float32(row[1:]).reshape(-1, 2) * size).round().astype(np.int32)
            cv2.fillPoly(label, [polygon], NAMES.index(name) if name else 0)
        boxes = [box for box in detector(image) if not is_outlined(box, label != IGNORE)]
        yield stem, image, two_opinions(label, segmenter(image), boxes)
    clone.close()


SETS = {f.__name__: f for f in (voc, coco, clothes, rooms, furniture)}


def smaller(image, interpolation=cv2.INTER_AREA):
    scale = MAX_SIDE / max(image.shape[:2])
    return image if scale >= 1 else cv2.resize(image, None, fx=scale, fy=scale, interpolation=interpolation)


def write(folder, samples, apart=False):
    """@param samples  (stem, BGR image, label image), of one size each  @param apart  images with people go to a
    folder of their own, and so do others with anything of our classes  @return count"""
    counts = np.zeros(len(NAMES), int)
    count = nobody = 0
    for stem, image, label in samples:
        image, label = smaller(image), smaller(label, cv2.INTER_NEAREST)
        seen = np.bincount(label.ravel(), minlength=256)[:len(NAMES)] > 0
        to = folder + ('_people' if apart and seen[PERSON] else '_furnished' if apart and seen[1:].any() else '')
        for name in ('images', 'labels'):
            os.makedirs(os.path.join(to, name), exist_ok=True)
        if not (cv2.imwrite(os.path.join(to, 'images', stem + '.jpg'), image, [cv2.IMWRITE_JPEG_QUALITY, 92])
                and cv2.imwrite(os.path.join(to, 'labels', stem + '.png'), label)):
            raise SystemExit(f"'{to}' cannot be written to: is the disk full?")
        counts += seen
        count += 1
        nobody += not seen[PERSON]
    shown = ', '.join(f'{name} {n}' for name, n in zip(NAMES[1:], counts[1:]) if n)
    print(f'{folder}: {count} images, {nobody} without people; {shown}', flush=True)
    return count


def main(argv=None):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('clones')
    parser.add_argument('out')
    parser.add_argument('--segmenter', required=True)
    parser.add_argument('--detector', required=True)
    parser.add_argument('--sets', nargs='+', choices=SETS, default=list(SETS))
    args = parser.parse_args(argv)
    cv2.setNumThreads(1)
    detector, segmenter = Detector(args.detector), Segmenter(args.segmenter)
    for name in args.sets:
        if not write(os.path.join(args.out, name), SETS[name](args.clones, segmenter, detector), name == 'voc'):
            raise SystemExit(f'{name}: no photographs in its clones')


if __name__ == '__main__':
    main()

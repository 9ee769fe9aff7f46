# SPDX-FileCopyrightText: 2026 The semantic_vslam authors
# SPDX-License-Identifier: BSD-3-Clause
"""Tests of models/training. Those that need PyTorch are skipped where it is absent: users need none."""
import base64
import csv
import hashlib
import io
import os
import re
import subprocess
import sys
import tarfile
import tempfile
import unittest
from unittest import mock

import cv2
import numpy as np

sys.path.insert(0, os.path.join(os.path.dirname(__file__), '..', '..', 'models', 'training'))

import augment
import label_sequence
import photographs
import second_opinion
from classes import IGNORE, NAMES, PERSON, label_of_coco

try:
    import torch
    torch.set_num_threads(1)
    import bisenetv2
    import blend
    import dataset
    import evaluate
    import export
    import fast_graph
    import narrow
    import network_file
    import prepare_photographs
    import quantize
    import scores
    import train
except ImportError:
    torch = None
try:
    import onnx
except ImportError:
    onnx = None
try:
    import onnxruntime
except ImportError:
    onnxruntime = None

SIZE = (96, 64)
READY_NETWORK = os.path.join(os.path.dirname(__file__), '..', '..', '..', 'shared', 'data', 'models', 'deeplabv3_mnv2_pascal_quant.onnx')


def make_scenes(folder, count=12):
    """Red people of varying place and size before green walls with blue monitors."""
    rng = np.random.default_rng(2)
    for name in ('images', 'labels'):
        os.makedirs(os.path.join(folder, name))
    for i in range(count):
        image = np.full((64, 96, 3), (60, 160, 60), np.uint8)
        label = np.zeros((64, 96), np.uint8)
        for c, colour in ((PERSON, (40, 40, 200)), (NAMES.index('monitor'), (200, 60, 40))):
            x, y, w, h = (int(rng.integers(*bounds)) for bounds in ((0, 60), (0, 20), (20, 36), (24, 44)))
            cv2.rectangle(image, (x, y), (x + w, y + h), colour, -1)
            cv2.rectangle(label, (x, y), (x + w, y + h), c, -1)
        cv2.imwrite(os.path.join(folder, 'images', f'{i:03d}.png'), image)
        cv2.imwrite(os.path.join(folder, 'labels', f'{i:03d}.png'), label)


class Classes(unittest.TestCase):
    def test_coco_names_map_to_ours(self):
        table = label_of_coco({0: 'unlabeled', 1: 'person', 2: 'bicycle', 67: 'dining table', 72: 'tv'})
        self.assertEqual((table[0], table[1], table[2]), (IGNORE, PERSON, 0))
        self.assertEqual((table[67], table[72], table[99]), (NAMES.index('table'), NAMES.index('monitor'), IGNORE))


class Augmentation(unittest.TestCase):
    def setUp(self):
        self.image = np.random.default_rng(1).integers(0, 256, (120, 160, 3), np.uint8)
        self.label = np.zeros((120, 160), np.uint8)
        self.label[30:90, 60:100] = PERSON

    def test_crop_moves_image_and_label_alike(self):
        image = np.repeat(np.where(self.label == PERSON, 255, 0).astype(np.uint8)[..., None], 3, 2)
        for seed in range(20):
            part, label, _ = augment.crop(image, self.label, SIZE, np.random.default_rng(seed))
            self.assertEqual((part.shape, label.shape), ((64, 96, 3), (64, 96)))
            known = label != IGNORE
            differ = ((part[..., 0] > 127) != (label == PERSON)) & known
            self.assertLess(differ.mean(), 0.04)  # the object's edge alone

    def test_photometric_keeps_the_shape_and_is_seeded(self):
        for seed in range(20):
            a = augment.photometric(self.image, np.random.default_rng(seed))
            b = augment.photometric(self.image, np.random.default_rng(seed))
            self.assertEqual((a.shape, a.dtype), (self.image.shape, np.uint8))
            self.assertTrue((a == b).all())


class Pasting(unittest.TestCase):
    """People of one colour, on an image whose left half is 1 m away and whose right half is 3 m away."""

    def setUp(self):
        self.cutout = augment.Cutout(PERSON, np.full((60, 40, 3), 200, np.uint8), np.ones((60, 40), np.uint8))
        self.depth = np.repeat(np.uint16([1000, 3000]), 64)[None].repeat(96, 0)

    def paste(self, depth, seed):
        image, label = np.zeros((96, 128, 3), np.uint8), np.zeros((96, 128), np.uint8)
        return self.cutout.paste(image, label, depth, np.random.default_rng(seed))

    def test_what_is_nearer_hides_a_person_and_what_is_farther_does_not(self):
        in_front = behind = 0
        for seed in range(60):
            whole = self.paste(None, seed)[1] == PERSON
            if not (whole[:, :60].sum() > 100 and whole[:, 68:].sum() > 100):
                continue
            depth = self.depth.copy()
            image, label = self.paste(depth, seed)
            self.assertTrue((label == PERSON)[whole][self.depth[whole] == 3000].all() or not (label == PERSON).any())
            near = whole & (self.depth == 1000)
            in_front += bool((label[near] == PERSON).all())
            if not (label[near] == PERSON).any():
                behind += 1
                self.assertLess(image[:, :56].max(), 10)  # its soft edge reaches a little over
        self.assertGreater(in_front, 5)
        self.assertGreater(behind, 5)

    def test_the_depth_image_gets_the_distance_of_the_person_who_may_hide_the_next_one(self):
        for seed in range(20):
            depth = self.depth.copy()
            person = self.paste(depth, seed)[1] == PERSON
            self.assertLessEqual(len(np.unique(depth[person])), 1)
            self.assertTrue((depth[person] <= self.depth[person]).all())
            self.assertTrue((depth[~person] == self.depth[~person]).all())

    def test_some_people_are_so_near_that_the_image_shows_a_part(self):
        shares = [(self.paste(None, seed)[1] == PERSON).mean() for seed in range(100)]
        self.assertGreater(np.quantile(shares, 0.8), 0.25)
        self.assertLess(np.quantile(shares, 0.1), 0.15)


class LabelSequence(unittest.TestCase):
    """A wall 1 m ahead with a book on it, and a camera that moves 0.1 m to the right."""

    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        for name in ('rgb', 'depth'):
            os.makedirs(os.path.join(self.folder.name, name))
        lines = []
        for i in range(2):
            cv2.imwrite(os.path.join(self.folder.name, f'rgb/{i}.jpg'), np.zeros((96, 128, 3), np.uint8))
            cv2.imwrite(os.path.join(self.folder.name, f'depth/{i}.png'), np.full((96, 128), 5000, np.uint16))
            lines.append(f'{i} rgb/{i}.jpg {i} depth/{i}.png\n')
        self.write('associations.txt', ''.join(lines))
        self.write('groundtruth.txt', '0 0 0 0 0 0 0 1\n1 0.1 0 0 0 0 0 1\n')
        self.write('objects.yaml', 'camera: {intrinsics: [100, 100, 63.5, 47.5], distortion: [0, 0, 0, 0, 0]}\n'
                   'table: {frame: rgb/0.jpg, outline: [[0, 0], [120, 0], [120, 90], [0, 90]]}\n'
                   'objects: [{frame: rgb/0.jpg, label: book, outline: [[40, 20], [70, 20], [70, 60], [40, 60]]}]\n')

    def tearDown(self):
        self.folder.cleanup()

    def write(self, name, text):
        with open(os.path.join(self.folder.name, name), 'w', encoding='utf-8') as out:
            out.write(text)

    def test_carries_outlines_along(self):
        out = os.path.join(self.folder.name, 'out')
        label_sequence.main([self.folder.name, os.path.join(self.folder.name, 'objects.yaml'), out])
        for i, x in ((0, 40), (1, 30)):  # 0.1 m at 1 m is 10 px of 100
            label = cv2.imread(os.path.join(out, 'labels', f'{i}.png'), cv2.IMREAD_GRAYSCALE)
            self.assertTrue((label[20:61, x:x + 31] == NAMES.index('book')).all())
            self.assertEqual((label == NAMES.index('book')).sum(), 41 * 31)
            self.assertEqual(label[80, 100], NAMES.index('table'))
            depth = cv2.imread(os.path.join(out, 'depth', f'{i}.png'), cv2.IMREAD_UNCHANGED)
            self.assertEqual((depth.dtype, depth.shape, depth[5, 5]), (np.uint16, label.shape, 5000))


def photograph(seed):
    """Colourful and large enough to be taken for a photograph."""
    noise = np.random.default_rng(seed).integers(0, 256, (9, 12, 3), np.uint8)
    return cv2.resize(noise, (800, 600), interpolation=cv2.INTER_CUBIC)


class Photographs(unittest.TestCase):
    """Packages come from a stand-in for npm that hands out one archive."""

    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.archive, self.list = self.path('a-1.0.0.tgz'), self.path('list.txt')
        recoded = cv2.resize(photograph(1), (640, 480))
        drawing = np.full((600, 800, 3), 255, np.uint8)
        cv2.putText(drawing, 'chart', (40, 400), cv2.FONT_HERSHEY_SIMPLEX, 9, (0, 0, 200), 40)
        with tarfile.open(self.archive, 'w:gz') as archive:
            for name, image in (('1.jpg', photograph(1)), ('2.jpg', recoded), ('3.jpg', photograph(2)),
                                ('4.jpg', drawing), ('5.jpg', photograph(3)[:200])):
                cv2.imwrite(self.path(name), image, [cv2.IMWRITE_JPEG_QUALITY, 95])
                archive.add(self.path(name), 'package/' + name)
        npm = self.path('npm')
        with open(npm, 'w', encoding='utf-8') as script:
            script.write(f'#!/bin/sh\n[ "$2" = a@1.0.0 ] && cp {self.archive} "$5" && echo a-1.0.0.tgz\n')
        os.chmod(npm, 0o755)
        with open(self.archive, 'rb') as archive:
            digest = base64.b64encode(hashlib.sha512(archive.read()).digest()).decode()
        self.write_list(f'# a comment\na 1.0.0 MIT sha512-{digest}\n')

    def tearDown(self):
        self.folder.cleanup()

    def path(self, name):
        return os.path.join(self.folder.name, name)

    def write_list(self, text):
        with open(self.list, 'w', encoding='utf-8') as out:
            out.write(text)

    def gather(self):
        with mock.patch.dict(os.environ, PATH=self.folder.name + os.pathsep + os.environ['PATH']):
            photographs.main([self.path('out'), '--packages', self.list])
        return [cv2.imread(os.path.join(self.path('out/images'), name)) for name in os.listdir(self.path('out/images'))]

    def test_are_taken_once_and_made_small(self):
        images = self.gather()
        self.assertEqual([image.shape for image in images], 2 * [(480, 640, 3)])

    def test_another_archive_than_the_listed_one_is_refused(self):
        self.write_list('a 1.0.0 MIT sha512-AAAA\n')
        with self.assertRaisesRegex(SystemExit, 'a@1.0.0 is another archive'):
            self.gather()

    def test_a_package_that_does_not_come_is_named(self):
        self.write_list('b 2.0.0 MIT sha512-AAAA\n')
        with self.assertRaisesRegex(SystemExit, 'b@2.0.0: npm pack failed'):
            self.gather()

    def test_the_list_of_the_repository_reads(self):
        rows = photographs.read_list(os.path.join(os.path.dirname(photographs.__file__), 'photographs.txt'))
        self.assertGreater(len(rows), 40)
        self.write_list('a 1.0.0 sha512-AAAA\n')
        with self.assertRaisesRegex(SystemExit, 'must be: name version'):
            photographs.read_list(self.list)


class SecondOpinion(unittest.TestCase):
    """A label image of 100x100 px with a person of 40x60."""

    def setUp(self):
        self.label = np.full((100, 100), IGNORE, np.uint8)
        self.label[20:80, 30:70] = PERSON

    @staticmethod
    def box(coco, score, left, top, right, bottom):
        return coco, score, np.array([left, top], float), np.array([right, bottom], float)

    def test_keeps_people_that_both_see(self):
        label = second_opinion.second_opinion(self.label, [self.box(0, 0.9, 30, 20, 70, 80)])
        self.assertTrue((label[20:80, 30:70] == PERSON).all())
        self.assertEqual(label[5, 5], 0)
        self.assertEqual(label[18, 50], IGNORE)  # may still be hair

    def test_leaves_unknown_what_may_be_one_of_our_classes(self):
        keyboard, kite = self.box(66, 0.1, 0, 0, 20, 20), self.box(33, 0.9, 80, 0, 100, 20)
        label = second_opinion.second_opinion(self.label, [self.box(0, 0.9, 30, 20, 70, 80), keyboard, kite])
        self.assertEqual((label[10, 10], label[10, 90]), (IGNORE, 0))

    def test_makes_the_surroundings_of_whole_people_background(self):
        label = np.full((100, 100), IGNORE, np.uint8)
        label[20:80, 30:50] = PERSON
        for right, expected in ((65, 0), (95, IGNORE)):  # filled to more, and to less, than two fifths
            box = self.box(0, 0.9, 30, 20, right, 80)
            self.assertEqual(second_opinion.second_opinion(label, [box])[50, 60], expected)

    def test_decodes_the_detectors_boxes(self):
        found = np.zeros((8 * 8 + 4 * 4 + 2 * 2, 85), np.float32)  # of an input of 64 px
        found[8 * 8 + 4 * 1 + 2, :4] = 0.5, 0.25, np.log(2), np.log(1)  # cell (2, 1) of the grid of 16 px
        found[8 * 8 + 4 * 1 + 2, [4, 5 + 63]] = 0.8, 0.5
        (coco, score, first, last), = second_opinion.decode(found, 64)
        self.assertEqual(coco, 63)
        self.assertAlmostEqual(score, 0.4)
        self.assertTrue(np.allclose([first, last], [[24, 12], [56, 28]]))

    def test_says_that_a_folder_is_empty(self):
        with tempfile.TemporaryDirectory() as folder, mock.patch.object(second_opinion, 'Detector'):
            with self.assertRaisesRegex(SystemExit, 'holds no images'):
                second_opinion.main(['yolox.onnx', folder])

    def test_drops_what_they_disagree_on(self):
        self.assertIsNone(second_opinion.second_opinion(self.label, []))
        self.assertIsNone(second_opinion.second_opinion(self.label, [self.box(0, 0.9, 30, 20, 70, 40)]))
        nobody = np.full((100, 100), IGNORE, np.uint8)
        self.assertIsNone(second_opinion.second_opinion(nobody, [self.box(0, 0.9, 30, 20, 70, 80)]))
        self.assertTrue((second_opinion.second_opinion(nobody, []) == 0).all())


@unittest.skipIf(torch is None, 'needs PyTorch')
class PreparedPhotographs(unittest.TestCase):
    """Label images of 100x100 px; no network is run."""

    def setUp(self):
        self.chair = np.full((100, 100), IGNORE, np.uint8)
        self.chair[20:80, 30:70] = NAMES.index('chair')
        self.nothing = np.zeros((100, 100), np.uint8)

    def commit(self, folder, name, files):
        """A repository with these files."""
        path = os.path.join(folder, name)
        for file, content in files.items():
            os.makedirs(os.path.dirname(os.path.join(path, file)), exist_ok=True)
            with open(os.path.join(path, file), 'wb') as out:
                out.write(content)
        git = ['git', '-C', path, '-c', 'user.name=n', '-c', 'user.email=e']
        for command in (['init', '-q'], ['add', '.'], ['commit', '-qm', 'm']):
            subprocess.run(git + command, check=True, capture_output=True)

    @staticmethod
    def jpeg(rows=100, columns=100):
        return cv2.imencode('.jpg', np.full((rows, columns, 3), 90, np.uint8))[1].tobytes()

    def test_coco_instances_are_drawn_the_smaller_on_top(self):
        def square(left, right, category, **more):
            corners = [left, left, right, left, right, right, left, right]
            return dict(area=(right - left) ** 2, category_id=category, segmentation=[corners], **more)

        crowd = {'area': 9, 'category_id': 1, 'iscrowd': 1, 'bbox': [0, 0, 60, 60], 'segmentation': {}}
        label = prepare_photographs.draw_instances((100, 100), [square(20, 40, 1), square(10, 90, 2), square(50, 70, 3), crowd],
                                                   {1: 'person', 2: 'table', 3: 'dog'})
        self.assertEqual([label[k, k] for k in (5, 30, 15, 60, 80, 95)], [IGNORE, PERSON, NAMES.index('table'), 0, NAMES.index('table'), 0])

    def test_what_a_label_set_does_not_name_is_unknown(self):
        boxes = [SecondOpinion.box(63, 0.2, 0, 0, 10, 10), SecondOpinion.box(0, 0.2, 20, 0, 30, 10), SecondOpinion.box(33, 0.2, 40, 0, 50, 10)]
        label = prepare_photographs.unnamed(self.nothing, boxes, (0,))
        self.assertEqual((label[5, 5], label[5, 25], label[5, 45]), (IGNORE, 0, 0))  # a laptop; a person, whom it names; a kite

    def test_both_networks_must_see_nothing_for_background(self):
        segmented = self.nothing.copy()
        segmented[:, 90:] = PERSON
        label = prepare_photographs.two_opinions(self.chair, segmented, [SecondOpinion.box(0, 0.9, 0, 0, 10, 10)])
        self.assertEqual((label[5, 5], label[50, 95], label[50, 80], label[50, 50]), (IGNORE, IGNORE, 0, NAMES.index('chair')))
        empty = prepare_photographs.two_opinions(self.chair, segmented, [SecondOpinion.box(0, 0.9, 0, 0, 10, 10)], people=False)
        self.assertEqual((empty[5, 5], empty[50, 95]), (0, 0))

    def test_furniture_is_taken_where_both_networks_see_it(self):
        label = prepare_photographs.agreed(np.where(self.chair == IGNORE, 0, self.chair), [SecondOpinion.box(56, 0.9, 50, 0, 100, 100)])
        self.assertEqual((label[50, 60], label[50, 40], label[50, 90]), (NAMES.index('chair'), IGNORE, IGNORE))

    def test_a_box_about_an_outline_tells_nothing_more(self):
        outlined = self.chair != IGNORE
        for box, expected in ((SecondOpinion.box(56, 0.9, 28, 22, 74, 82), True), (SecondOpinion.box(56, 0.9, 0, 0, 90, 90), False)):
            self.assertEqual(prepare_photographs.is_outlined(box, outlined), expected)
        self.assertFalse(prepare_photographs.is_outlined(box, np.zeros_like(outlined)))

    def test_rooms_and_furniture_of_a_clone(self):
        with tempfile.TemporaryDirectory() as folder, mock.patch.multiple(
                prepare_photographs, Detector=lambda path: lambda image: [], Segmenter=lambda path: lambda image: np.zeros(image.shape[:2], np.uint8)):
            self.commit(folder, prepare_photographs.ROOMS[0],
                        {'Houses Dataset/1_kitchen.jpg': self.jpeg(1000, 1280), 'Houses Dataset/1_frontal.jpg': self.jpeg()})
            self.commit(folder, prepare_photographs.FURNITURE[0],
                        {'Data/train/images/img1_jpg.rf.0123456789.jpg': self.jpeg(640, 640),
                         'Data/train/labels/img1_jpg.rf.0123456789.txt': b'1 0.25 0.25 0.75 0.25 0.75 0.75 0.25 0.75\n',
                         'Data/train/images/701-112_jpg.rf.0.jpg': self.jpeg()})
            out = os.path.join(folder, 'out')
            options = ['--segmenter', 'x', '--detector', 'y', '--sets']
            prepare_photographs.main([folder, out, *options, 'rooms', 'furniture'])
            found = dataset.LabelledFolder(os.path.join(out, 'rooms'))
            self.assertEqual(len(found), 1)
            self.assertEqual(found.load(0).image.shape, (500, 640, 3))
            self.assertFalse(found.load(0).label.any())
            found = dataset.LabelledFolder(os.path.join(out, 'furniture'))
            self.assertEqual(len(found), 1)
            label = found.load(0).label
            self.assertEqual((label[label.shape[0] // 2, label.shape[1] // 2], label[5, 5]), (NAMES.index('chair'), 0))
            image = np.zeros((8, 8, 3), np.uint8)
            labels = [np.full((8, 8), c, np.uint8) for c in (0, PERSON, NAMES.index('chair'))]
            prepare_photographs.write(os.path.join(out, 'voc'), [(str(c), image, label) for c, label in enumerate(labels)], apart=True)
            for c, name in enumerate(('voc', 'voc_people', 'voc_furnished')):
                self.assertEqual(os.listdir(os.path.join(out, name, 'images')), [f'{c}.jpg'])
            with self.assertRaisesRegex(SystemExit, 'is no clone'):
                prepare_photographs.main([folder, out, *options, 'clothes'])


@unittest.skipIf(torch is None, 'needs PyTorch')
class Network(unittest.TestCase):
    def test_its_semantic_branch_has_the_published_size(self):
        """MobileNetV2 of width 1 has 3.4 million weights, 1280 * (320 + 1001) of them behind what is taken, and 2 for each channel in
        normalisations that are biases here."""
        parameters = sum(p.numel() for p in bisenetv2.mobilenet_v2().parameters())
        self.assertLess(abs(parameters / (3.505e6 - 1280 * (320 + 1001) - 2560) - 1), 0.02)

    def test_gives_logits_at_an_eighth(self):
        model = bisenetv2.BiSeNetV2(11, head_channels=64)
        self.assertEqual(tuple(model(torch.zeros(2, 3, 64, 80)).shape), (2, 11, 8, 10))

    @unittest.skipUnless(onnx and onnxruntime and os.path.isfile(READY_NETWORK), 'needs onnx, onnxruntime and ../shared/data')
    def test_begins_with_the_public_network_and_computes_what_it_does(self):
        model = bisenetv2.BiSeNetV2(len(NAMES)).eval()
        found = network_file.read_weights(READY_NETWORK)
        model.load_state_dict(found, strict=False)
        lacking = {name.split('.')[0] for name in model.state_dict() if name not in found}
        self.assertEqual(lacking, {'detail', 'aggregate', 'head'})
        graph = onnx.load(READY_NETWORK)
        logits = [node.output[0] for node in graph.graph.node if node.op_type == 'Conv'][-1]
        graph.graph.output.append(onnx.ValueInfoProto(name=logits))
        session = onnxruntime.InferenceSession(graph.SerializeToString())
        image = cv2.resize(photograph(7), (513, 513))[..., ::-1].copy()
        expected = session.run([logits], {session.get_inputs()[0].name: image[None]})[0][0]
        with torch.no_grad():
            ours = model.coarse(model.semantic(network_file.normalise(dataset.planar(image)[None]))[1])[0].numpy()
        for name, c in (('background', 0), ('person', 15), ('monitor', 20)):  # the network rounds what is between its layers
            self.assertGreater(np.corrcoef(ours[NAMES.index(name)].ravel(), expected[c].ravel())[0, 1], 0.97, name)

    def test_two_scales_find_the_inside_of_large_people_and_leave_edges_to_the_whole_image(self):
        logits, half = torch.zeros(1, len(NAMES), 40, 60), torch.zeros(1, len(NAMES), 20, 30)
        logits[:, 0], half[:, 0] = 1, 1
        logits[:, PERSON, 2:5, 2:5] = 2       # a small person of the whole image
        half[:, PERSON, 2:18, 16:] = 3        # a large one of the half: rows 4 to 35, columns 32 on
        half[:, PERSON, 10:11, 4:5] = 3       # and one as large as a cell
        found = bisenetv2.with_large_people(logits, half).argmax(1)[0] == PERSON
        expected = torch.zeros(40, 60, dtype=torch.bool)
        edge = bisenetv2.EDGE_CELLS
        expected[2:5, 2:5] = expected[4 + edge:36 - edge, 32 + edge:] = True
        self.assertTrue(torch.equal(found, expected), found.int())

    def test_hard_pixel_loss_ignores_unlabelled_pixels(self):
        logits = torch.zeros(1, len(NAMES), 2, 2)
        logits[0, PERSON] = 9
        label = torch.full((1, 16, 16), IGNORE, dtype=torch.long)
        self.assertEqual(train.hard_pixel_loss(logits, label).item(), 0)
        for c in (0, 2):
            label[0, :8] = c  # half the image is wrong: each such pixel loses about 9
            self.assertAlmostEqual(train.hard_pixel_loss(logits, label).item(), 9 * train.CLASS_WEIGHTS[c], places=1)

    def test_learning_rate_rises_and_falls(self):
        rates = [train.learning_rate(progress, 1.0) for progress in (0, 0.025, 0.05, 0.5, 1)]
        self.assertLess(rates[0], rates[1])
        self.assertAlmostEqual(rates[2], 1)
        self.assertLess(rates[3], 1)
        self.assertAlmostEqual(rates[4], 0)


@unittest.skipIf(torch is None, 'needs PyTorch')
class Scores(unittest.TestCase):
    def test_iou_by_hand(self):
        truth = np.array([[1, 1, 0, 0], [1, 1, 0, IGNORE]], np.uint8)
        predicted = np.array([[1, 0, 0, 1], [1, 1, 0, 1]], np.uint8)
        confusion = scores.Confusion()
        confusion.add(truth, predicted)
        iou = confusion.iou()
        self.assertAlmostEqual(iou['person'], 3 / 5)
        self.assertAlmostEqual(iou['background'], 2 / 4)
        self.assertEqual(set(iou), {'person', 'background'})
        self.assertAlmostEqual(scores.mean_iou(iou), 3 / 5)
        self.assertEqual(confusion.people(), (3 / 4, 3 / 4))
        self.assertIsNone(confusion.false_people())

    def test_false_people_count_where_nobody_is(self):
        confusion = scores.Confusion()
        person = np.full((2, 2), PERSON, np.uint8)
        confusion.add(person, person)
        confusion.add(np.array([[0, 0], [0, IGNORE]], np.uint8), np.array([[0, 0], [1, 1]], np.uint8))
        confusion.add(np.zeros((2, 2), np.uint8), np.zeros((2, 2), np.uint8))
        self.assertEqual(confusion.false_people(), 1 / 4)  # half of one image, none of the other


@unittest.skipIf(torch is None, 'needs PyTorch')
class Training(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.data, self.out = os.path.join(self.folder.name, 'data'), os.path.join(self.folder.name, 'out')
        make_scenes(self.data)

    def tearDown(self):
        self.folder.cleanup()

    def arguments(self, steps, *more):
        return ['--data', self.data, '--out', self.out, '--size', '96x64', '--steps', str(steps), '--batch', '4', '--head', '32',
                '--workers', '0', '--evaluate-every', '5', *more]

    def train(self, steps, *more):
        return train.main(self.arguments(steps, *more))

    def losses(self):
        with open(os.path.join(self.out, 'log.csv'), encoding='utf-8') as text:
            return [float(row['loss']) for row in csv.DictReader(text)]

    def test_a_few_steps_lower_the_loss(self):
        self.train(25)
        losses = self.losses()
        self.assertLess(losses[-1], 0.75 * losses[0])

    def test_goes_on_where_it_stopped(self):
        self.train(5)
        self.assertEqual(self.train(10).step, 10)
        self.assertEqual(len(self.losses()), 2)
        with self.assertRaises(SystemExit):
            self.train(10, '--head', '64')

    def test_features_that_a_training_begins_with_stay_as_they_are(self):
        self.train(2)
        before, started = os.path.join(self.out, 'last.pt'), network_file.load_checkpoint(os.path.join(self.out, 'last.pt'))['model']
        for more, stay in (([], True), (['--train-features'], False)):
            self.out = os.path.join(self.folder.name, f'stay_{stay}')
            self.train(3, '--from', before, *more)
            self.train(5, '--from', before, *more)  # goes on
            after, name = network_file.load_checkpoint(os.path.join(self.out, 'last.pt'))['model'], 'semantic.features.2.body.0.weight'
            self.assertEqual(torch.equal(after[name], network_file.load_checkpoint(before)['average'][name]), stay)
            self.assertFalse(torch.equal(after['head.2.weight'], started['head.2.weight']))

    @unittest.skipIf(torch is not None and torch.__version__.startswith('1.'), "PyTorch 1's torchrun fails on Python 3.11")
    def test_two_processes_learn_as_one(self):
        """Each has samples of its own, so that their weights are alike only if they share them; one writes the files."""
        script = os.path.join(self.folder.name, 'run.py')
        with open(script, 'w', encoding='utf-8') as out:
            out.write(f'import sys; sys.path.insert(0, {os.path.dirname(train.__file__)!r})\n'
                      'import torch, torch.distributed as d, train\n'
                      'model = train.main().model\n'
                      'least = torch.cat([p.detach().flatten() for p in model.parameters()])\n'
                      'most = least.clone()\n'
                      'd.all_reduce(least, d.ReduceOp.MIN); d.all_reduce(most, d.ReduceOp.MAX)\n'
                      'assert torch.equal(least, most), "the processes\\\' weights differ"\n')
        arguments = ['--data', self.data, '--out', self.out, '--size', '96x64', '--steps', '10', '--batch', '2', '--head', '32',
                     '--workers', '0', '--evaluate-every', '5', '--threads', '1']
        done = subprocess.run([sys.executable, '-m', 'torch.distributed.run', '--nproc_per_node', '2', script, *arguments],
                              capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(len(self.losses()), 2)
        self.assertEqual(train.load_checkpoint(os.path.join(self.out, 'last.pt'))['step'], 10)

    def test_ends_when_its_time_is_over(self):
        training = self.train(10**6, '--minutes', '0.02')
        self.assertGreater(training.seconds, 0.02 * 60)
        self.assertLess(training.step, 10**4)
        self.assertTrue(os.path.exists(os.path.join(self.out, 'last.pt')))

    def test_samples_do_not_depend_on_when_they_are_asked_for(self):
        sources = [(dataset.LabelledFolder(self.data), 1.0)]
        first, again = (dataset.AugmentedSamples(sources, [SIZE, (64, 64)], 8, turn=3) for _ in range(2))
        self.assertEqual([tuple(first[k][1].shape) for k in (2, 3, 5, 6)], [SIZE[::-1], (64, 64), (64, 64), SIZE[::-1]])
        for x, y in zip(first[7], again[7]):
            self.assertTrue(torch.equal(torch.nan_to_num(x), torch.nan_to_num(y)))

    def test_held_back_images_are_never_trained_on(self):
        kept = dataset.LabelledFolder(self.data).split(held_back=False).pairs
        held = dataset.LabelledFolder(self.data).split(held_back=True).pairs
        self.assertEqual(len(kept) + len(held), 12)
        self.assertFalse(set(kept) & set(held))

    def test_a_checkpoint_is_scored_and_exported(self):
        self.train(5)
        checkpoint = os.path.join(self.out, 'last.pt')
        result = evaluate.main([checkpoint, self.data, '--all', '--pictures', os.path.join(self.out, 'pictures')])
        self.assertEqual(result['images'], 12)
        self.assertEqual(len(os.listdir(os.path.join(self.out, 'pictures'))), 12)
        network = os.path.join(self.out, 'net.onnx')
        export.main([checkpoint, network])
        self.assertGreater(os.path.getsize(network), 1e6)
        with open(os.path.join(self.out, 'net.yaml'), encoding='utf-8') as text:
            self.assertIn('width: 96', text.read())

    @unittest.skipIf(onnx is None or onnxruntime is None, 'needs onnx and onnxruntime')
    def test_an_exported_and_a_quantised_network_score_as_the_checkpoint_does(self):
        self.train(5)
        checkpoint = os.path.join(self.out, 'last.pt')
        network, small = os.path.join(self.out, 'net.onnx'), os.path.join(self.out, 'net8.onnx')
        for options in (['--two-scales'], []):
            export.main([checkpoint, network, *options])
            quantize.main([network, small, os.path.join(self.data, 'images'), '--count', '4'])
            self.assertLess(os.path.getsize(small), 0.4 * os.path.getsize(network))
            graph = onnx.load(small).graph
            self.assertEqual(onnx.helper.printable_value_info(graph.input[0]), '%image[UINT8, 1x64x96x3]')
            self.assertFalse([n.name for n in graph.node if n.op_type == 'QuantizeLinear' and n.input[0] in fast_graph.pixels(graph)])
            with open(small.replace('.onnx', '.yaml'), encoding='utf-8') as text:
                sidecar = text.read()
            self.assertIn('layout: nhwc\n  type: uint8\n  channels: rgb\n  resize: stretch\noutput:', sidecar)
            model = network_file.load_network(checkpoint, two_scales=bool(options))[0]
            expected = scores.evaluate(model, [dataset.LabelledFolder(self.data)], SIZE)
            for path, tolerance in ((network, 1e-3), (small, 0.05)):
                found = evaluate.main([path, self.data, '--all'])['iou']
                for name in ('background', 'person'):
                    self.assertAlmostEqual(found.get(name, 0), expected.get(name, 0), delta=tolerance, msg=path)
        with self.assertRaisesRegex(SystemExit, 'cannot be loaded'):
            evaluate.main([os.path.join(self.out, 'none.onnx'), self.data])
        with self.assertRaisesRegex(SystemExit, 'holds no .jpg or .png'):
            quantize.main([network, small, self.folder.name])
        with open(os.path.join(self.folder.name, 'broken.png'), 'w', encoding='utf-8'):
            pass
        with self.assertRaisesRegex(SystemExit, "broken.png' does not load"):
            quantize.main([network, small, self.folder.name])
        with self.assertRaisesRegex(SystemExit, "sidecar '.*none.yaml' cannot be read"):
            quantize.main([os.path.join(self.out, 'none.onnx'), small, self.folder.name])
        with self.assertRaisesRegex(SystemExit, "'type': 'uint8'.* cannot be quantised; it must be .*'type': 'float32'"):
            quantize.main([small, small, self.folder.name])

    @unittest.skipIf(onnx is None or onnxruntime is None, 'needs onnx and onnxruntime')
    def test_a_network_is_quantised_by_what_its_sidecar_says(self):
        self.train(1)
        network, sidecar, small = (os.path.join(self.out, name) for name in ('net.onnx', 'net.yaml', 'net8.onnx'))
        export.main([os.path.join(self.out, 'last.pt'), network])
        with open(sidecar, encoding='utf-8') as text:
            written = text.read()
        images = os.path.join(self.data, 'images')
        image = np.random.default_rng(3).integers(0, 256, (1, 64, 96, 3), np.uint8)
        session = onnxruntime.InferenceSession(network)
        normalisations = (network_file.MEAN, network_file.STD), ((0.1, 0.2, 0.3), (0.2, 0.25, 0.3))
        for chosen, (mean, std) in enumerate(normalisations):
            with open(sidecar, 'w', encoding='utf-8') as out:
                out.write(re.sub('mean: .*', f'mean: {list(mean)}', re.sub('std: .*', f'std: {list(std)}', written)))
            quantize.main([network, small, images, '--count', '4'])
            found = onnxruntime.InferenceSession(small).run(None, {'image': image})[0]
            away = [np.abs(found - session.run(None, {'image': given})[0]).mean()
                    for given in (((image / 255 - m) / s).astype(np.float32).transpose(0, 3, 1, 2) for m, s in normalisations)]
            self.assertEqual(int(np.argmin(away)), chosen)
            self.assertLess(2 * min(away), max(away), away)
        for content, message in ((written.replace('  std', '  stdd'), "has no 'std' of its input"), ('[', "net.yaml' is none: "),
                                 ('nothing', "net.yaml' is none: ")):
            with open(sidecar, 'w', encoding='utf-8') as out:
                out.write(content)
            with self.assertRaisesRegex(SystemExit, message):
                quantize.main([network, small, images])
        with open(sidecar, 'w', encoding='utf-8') as out:
            out.write(written)
        graph = onnx.load(network)
        graph.graph.node.insert(0, onnx.helper.make_node('Neg', ['image'], ['negative']))
        for node in graph.graph.node[1:]:
            node.input[:] = ['negative' if name == 'image' else name for name in node.input]
        onnx.save(graph, network)
        with self.assertRaisesRegex(SystemExit, 'does not begin with convolutions of its image'):
            quantize.main([network, small, images])

    @unittest.skipIf(onnx is None or onnxruntime is None, 'needs onnx and onnxruntime')
    def test_a_network_prepared_for_quantising_computes_the_same_with_convolutions_that_are_fast(self):
        self.train(5)
        mean, std = [114, 114, 114], [58, 57, 56]  # of one grey, or borders differ
        pixels = np.random.default_rng(3).uniform(0, 255, (1, 64, 96, 3)).astype(np.float32) - fast_graph.grey(mean)
        image = (pixels.transpose(0, 3, 1, 2) / np.reshape(std, (3, 1, 1))).astype(np.float32)
        for options in ([], ['--small'], ['--small', '--two-scales']):
            scales = 1 + ('--two-scales' in options)
            network, prepared = (os.path.join(self.out, name) for name in ('net.onnx', 'net.float'))
            export.main([os.path.join(self.out, 'last.pt'), network, *options])
            fast_graph.prepare(network, prepared, mean, std)
            expected, found = (onnxruntime.InferenceSession(path).run(None, {'image': given})[0]
                               for path, given in ((network, image), (prepared, pixels)))
            self.assertLess(np.abs(found - expected).max(), 1e-3 * np.abs(expected).max())
            graph = onnx.load(prepared).graph
            dims = {weights.name: tuple(weights.dims) for weights in graph.initializer}
            groups = [(next(a.i for a in n.attribute if a.name == 'group'), *dims[n.input[1]][:2])
                      for n in graph.node if n.op_type == 'Conv']
            self.assertTrue(all(group == out or group == 1 and given >= 8 for group, out, given in groups), groups)
            self.assertFalse([n.name for n in graph.node if n.op_type == 'BatchNormalization'])
            on_image = [n.op_type for n in graph.node if 'image' in n.input]
            self.assertEqual(on_image, ['Reshape'] * (1 + scales))  # which copies nothing
            read = {name for n in graph.node for name in n.input} | {graph.output[0].name}
            self.assertTrue(all(read.intersection(n.output) for n in graph.node))
            kernels = [w.raw_data for w in graph.initializer if len(w.dims) == 4]
            self.assertEqual(len(kernels), len(set(kernels)))  # both scales share them

    @unittest.skipIf(onnx is None or onnxruntime is None, 'needs onnx and onnxruntime')
    def test_ranges_of_activations_leave_the_rare_giants_out(self):
        helper, float32 = onnx.helper, onnx.TensorProto.FLOAT
        ends = [helper.make_tensor_value_info(name, float32, [1, 1, 200, 100]) for name in ('image', 'out')]
        graph = helper.make_graph([helper.make_node('Neg', ['image'], ['out'], name='n')], 'g', ends[:1], ends[1:])
        path = os.path.join(self.folder.name, 'neg.onnx')
        onnx.save(helper.make_model(graph, opset_imports=[helper.make_opsetid('', 13)], ir_version=8), path)
        images = np.random.default_rng(3).uniform(0, 1, (20, 1, 1, 200, 100)).astype(np.float32)
        images[:, 0, 0, 0, 0] = 50  # a pixel of 20000 in each image,
        images[7] *= 1000           # and all of one image in twenty
        reader = mock.Mock(get_next=mock.Mock(side_effect=[{'image': image} for image in images] + [None]))
        low, high = quantize.activation_ranges(path, reader)['out']
        self.assertAlmostEqual(low, -1, delta=0.01)
        self.assertLess(high, 0.01)

    def test_begins_with_the_weights_of_another_training_or_of_an_exported_network(self):
        self.train(5)
        files = [os.path.join(self.out, 'last.pt')]
        if onnx is not None:
            for options in ([], ['--small'], ['--two-scales']):
                files.append(os.path.join(self.out, f'net{len(files)}.onnx'))
                export.main([files[0], files[-1], *options])
        image = torch.rand(1, 3, 64, 96)
        with torch.no_grad():
            expected = network_file.load_network(files[0])[0](image)
            for path in files:
                self.out = os.path.join(self.folder.name, 'from_' + os.path.basename(path))
                model = train.Training(train.arguments(self.arguments(1, '--from', path))).model.eval()
                self.assertLess((model(image) - expected).abs().max(), 3e-2 * expected.abs().max(), path)
                with self.assertRaisesRegex(SystemExit, 'has 32 channels in its last head, not 64; leave --head out'):
                    train.Training(train.arguments(self.arguments(1, '--from', path, '--head', '64', '--out', self.out + '64')))
                with self.assertRaisesRegex(SystemExit, 'is not this network: .* of another shape'):
                    network_file.load_weights(bisenetv2.BiSeNetV2(len(NAMES), 64), network_file.read_weights(path), path)

    def test_a_narrowed_network_gives_the_logits_of_the_wide_one_and_is_trained_on(self):
        self.train(5)
        wide, small, smaller = (os.path.join(self.out, name) for name in ('last.pt', 'small.pt', 'smaller.pt'))
        saved = network_file.load_checkpoint(wide)
        for reader, needed in (('head.2', 4), ('head.0.0', 12), ('detail.1.0', 10), ('detail.2.0', 10), ('detail.6.0', 20)):
            saved['average'][f'{reader}.weight'][:, needed:] = 0
        network_file.save_checkpoint(wide, **saved)
        narrow.main([wide, small, self.data, '--head', '8', '--aggregated', '24', '--detail', '16', '16', '64', '64', '64', '40',
                     '--size', '96x64'])
        image = network_file.normalise(dataset.planar(dataset.LabelledFolder(self.data).load(3).image)[None])
        with torch.no_grad():
            expected, found = (network_file.load_network(path)[0](image) for path in (wide, small))
        self.assertEqual(network_file.widths(network_file.read_weights(small), small),
                         {'head_channels': 8, 'aggregated': 24, 'detail': (16, 16, 64, 64, 64, 40, 128, 128)})
        self.assertLess((found - expected).abs().max(), 0.05 * expected.std())
        self.out = os.path.join(self.folder.name, 'narrowed')
        train.main([option for option in self.arguments(1, '--from', small) if option not in ('--head', '32')])
        self.train(2, '--head', '8')  # goes on
        if onnx is not None:
            network = os.path.join(self.out, 'net.onnx')
            export.main([small, network])
            self.out = os.path.join(self.folder.name, 'exported')
            self.train(1, '--from', network, '--head', '8')
        with self.assertRaisesRegex(SystemExit, 'has 8 channels in head.0, of which 9 cannot be kept'):
            narrow.main([small, smaller, self.data, '--head', '9', '--size', '96x64'])
        for wrong, message in (([], 'give --head, --aggregated or --detail'), (['--head', '4', '--images', '0'], 'must be 1 or more'),
                               (['--detail', *'88888888'], 'up to 7 numbers, not 8')):
            with self.assertRaises(SystemExit), mock.patch('sys.stderr', io.StringIO()) as said:
                narrow.main([small, smaller, self.data, '--size', '96x64', *wrong])
            self.assertIn(message, said.getvalue())

    def test_blends_the_weights_before_and_after_a_training(self):
        self.train(3)
        before, blended = os.path.join(self.out, 'last.pt'), os.path.join(self.folder.name, 'blended.pt')
        self.out = os.path.join(self.folder.name, 'after')
        self.train(3, '--from', before)
        after = os.path.join(self.out, 'last.pt')
        blend.main([before, after, blended, '--share', '0.25'])
        old, new = (network_file.load_checkpoint(path)['average'] for path in (before, after))
        found = network_file.load_network(blended)[0].state_dict()
        moved = 0
        for name, value in found.items():
            if value.dtype.is_floating_point:
                torch.testing.assert_close(value, 0.75 * old[name] + 0.25 * new[name], rtol=1e-4, atol=1e-5)
                moved += int(not torch.equal(old[name], new[name]))
        self.assertGreater(moved, 100)
        with self.assertRaisesRegex(SystemExit, 'different widths: head.0.0.weight'):
            blend.blend(old, bisenetv2.BiSeNetV2(len(NAMES), 8).state_dict(), 0.5)
        with self.assertRaises(SystemExit), mock.patch('sys.stderr', io.StringIO()) as said:
            blend.main([before, after, blended, '--share', '2'])
        self.assertIn('must be 0 to 1', said.getvalue())
        with self.assertRaisesRegex(SystemExit, 'does not exist'):
            blend.main([before + '.none', after, blended])
        if onnx is not None:
            network = os.path.join(self.folder.name, 'before.onnx')
            export.main([before, network])
            blend.main([network, after, blended, '--share', '0'])
            found = network_file.load_checkpoint(blended)['average']
            torch.testing.assert_close(found['head.2.weight'], old['head.2.weight'])

    def test_says_what_is_wrong_with_the_weights_to_begin_with(self):
        with self.assertRaisesRegex(SystemExit, 'does not exist'):
            network_file.read_weights(os.path.join(self.out, 'none.pt'))
        broken = os.path.join(self.folder.name, 'broken.pt')
        for content, message in ((b'not a checkpoint', "broken.pt' is no checkpoint: "), (None, 'a file of PyTorch, but no checkpoint')):
            if content:
                with open(broken, 'wb') as out:
                    out.write(content)
            else:
                torch.save([1, 2], broken)
            with self.assertRaisesRegex(SystemExit, message):
                network_file.read_weights(broken)
        with self.assertRaisesRegex(SystemExit, "other.pt' is not this network: it has no 'head.0.0.weight'"):
            network_file.network_of({}, 'other.pt')
        if onnx is None:
            return
        with self.assertRaisesRegex(SystemExit, 'cannot be read: No such file'):
            network_file.read_weights(os.path.join(self.out, 'none.onnx'))
        broken = os.path.join(self.folder.name, 'broken.onnx')
        with open(broken, 'wb') as out:
            out.write(b'\xff not a network')
        with self.assertRaisesRegex(SystemExit, 'is no ONNX file'):
            network_file.read_weights(broken)

    def test_keeps_decoded_images_while_there_is_room(self):
        folder = dataset.LabelledFolder(self.data)
        self.assertIs(folder.load(0)[0], folder.load(0)[0])
        with mock.patch.object(dataset, 'KEPT_BYTES', 64 * 96 * 4):  # one image with its labels
            folder = dataset.LabelledFolder(self.data)
        first, second = folder.load(0), folder.load(1)
        self.assertIs(folder.load(0)[0], first[0])
        self.assertIsNot(folder.load(1)[0], second[0])
        self.assertTrue((folder.load(1)[0] == second[0]).all())

    def test_says_what_is_wrong_with_a_folder(self):
        with self.assertRaisesRegex(SystemExit, 'no labelled folder'):
            dataset.LabelledFolder(self.folder.name)
        self.assertIsNone(dataset.LabelledFolder(self.data).load(0).depth)
        os.makedirs(os.path.join(self.data, 'depth'))
        depth_file = os.path.join(self.data, 'depth', '000.png')
        cv2.imwrite(depth_file, np.full(dataset.LabelledFolder(self.data).load(0).label.shape, 700, np.uint16))
        self.assertTrue((dataset.LabelledFolder(self.data).load(0).depth == 700).all())
        cv2.imwrite(depth_file, np.zeros((64, 96), np.uint8))
        with self.assertRaisesRegex(SystemExit, 'no 16-bit image of the size of its labels'):
            dataset.LabelledFolder(self.data).load(0)


if __name__ == '__main__':
    unittest.main()

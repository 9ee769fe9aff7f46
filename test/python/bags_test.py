#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The semantic_vslam authors
# SPDX-License-Identifier: BSD-3-Clause
"""The recording in bags/ plays, and is what the command in bags/README.md makes."""
import json
import os
import re
import subprocess
import sys
import tempfile
import unittest

import numpy as np

sys.path.append(os.path.join(os.path.dirname(__file__), "..", "ros"))
from programs import program, skip_without_programs

BAGS = os.path.join(os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__)))), "bags")
BAG = os.path.join(BAGS, "walking.bag")


def messages(path):
    """@return topic -> [(stamp in ns, message)]"""
    import rosbag
    out = {}
    with rosbag.Bag(path) as bag:
        for topic, message, _ in bag.read_messages():
            out.setdefault(topic, []).append((message.header.stamp.to_nsec(), message))
    return out


def values(message):
    """What a message says, as numbers."""
    if message._type == "sensor_msgs/Image":
        kind = np.float32 if message.encoding == "32FC1" else np.uint8
        return np.nan_to_num(np.frombuffer(message.data, kind).astype(np.float64))
    if message._type == "sensor_msgs/CameraInfo":
        return np.array([message.width, message.height, *message.K, *message.P, *message.D])
    p, q = message.pose.position, message.pose.orientation
    return np.array([p.x, p.y, p.z, q.x, q.y, q.z, q.w])


class Walking(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        skip_without_programs()

    def test_is_small(self):
        self.assertLess(os.path.getsize(BAG), 3e6)

    def test_plays(self):
        for network in ([], ["--set", "segmentation.model="]):
            with self.subTest(network=network), tempfile.TemporaryDirectory() as out:
                done = subprocess.run([program("run_offline"), BAG, "--out", out, *network], capture_output=True, text=True, timeout=120)
                self.assertEqual(done.returncode, 0, done.stderr)
                with open(os.path.join(out, "summary.json")) as file:
                    summary = json.load(file)
                self.assertEqual((summary["ended"], summary["frames"]), ("complete", 32))
                self.assertGreaterEqual(summary["posed_share"], 0.95)
                self.assertLess(summary["ate_rmse_m"], 0.03)
                self.assertGreater(summary["mask"]["iou"], 0.7)
                self.assertGreater(summary["cloud_points"], 20000)

    def test_is_what_the_command_makes(self):
        with open(os.path.join(BAGS, "README.md")) as file:
            command = re.search(r"make_synthetic_bag --out walking\.bag (.*)", file.read())[1].split()
        with tempfile.TemporaryDirectory() as folder:
            made = os.path.join(folder, "walking.bag")
            subprocess.run([program("make_synthetic_bag"), "--out", made, *command], check=True, timeout=120, capture_output=True)
            self.assertLess(abs(os.path.getsize(made) - os.path.getsize(BAG)), 0.02 * os.path.getsize(BAG))
            made, kept = messages(made), messages(BAG)
        self.assertEqual(set(made), set(kept))
        for topic in kept:
            self.assertEqual([stamp for stamp, _ in made[topic]], [stamp for stamp, _ in kept[topic]], topic)
            for (_, one), (_, other) in zip(made[topic], kept[topic]):
                self.assertEqual((one._type, one.header.frame_id), (other._type, other.header.frame_id))
                difference = np.abs(values(one) - values(other))
                # Other compilers and processors round otherwise: a pixel at an edge may change, no more.
                self.assertLess(difference.mean(), 0.01 if topic != "/camera/rgb/image_color" else 0.5, topic)

    def test_topics_are_those_that_are_told(self):
        with open(os.path.join(BAGS, "README.md")) as file:
            told = re.findall(r"^\| (`/.*?) \| (\S+) \|", file.read(), re.M)
        told = {topic: kind for topics, kind in told for topic in re.findall(r"`(/[^`]*)`", topics)}
        self.assertEqual(told, {topic: found[0][1]._type for topic, found in messages(BAG).items()})


if __name__ == "__main__":
    unittest.main()

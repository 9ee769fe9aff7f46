#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The semantic_vslam authors
# SPDX-License-Identifier: BSD-3-Clause
"""Plays the rendered recording through a system with a network, or with one that does not load."""
import sys
import unittest

import rospy
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from semantic_vslam.msg import LabelInfo
from sensor_msgs.msg import Image
from slam_test import Listener, play, rendered_bag, wait_until
from std_srvs.srv import Trigger


class RunningSystem(unittest.TestCase):
    """A system that takes images, and what it says."""

    @classmethod
    def setUpClass(cls):
        rospy.init_node("network_test")
        cls.seen, cls.labels, cls.status = Listener(), [], {}
        cls.label_info, cls.overlays = [], []
        cls.subscribers = [rospy.Subscriber("segmentation/label_info", LabelInfo, cls.label_info.append),
                           rospy.Subscriber("segmentation/overlay", Image, cls.overlays.append, queue_size=500),
                           rospy.Subscriber("segmentation/labels", Image, cls.labels.append, queue_size=500),
                           rospy.Subscriber("/diagnostics", DiagnosticArray, cls.on_diagnostics)]
        wait_until(lambda: len(cls.status) == 4, 60, "a report of each stage")

    @classmethod
    def on_diagnostics(cls, message):
        for status in message.status:
            cls.status[status.name.split()[-1]] = status

    def wait_for_new_map(self, map_id):
        wait_until(lambda: self.seen.newest["tracking/keyframe_poses"].map_id != map_id, 20, "a new map")
        wait_until(lambda: self.seen.newest["tracking/keyframe_poses"].keyframes, 20, "keyframes of the new map")

    def map_id(self):
        return self.seen.newest["tracking/keyframe_poses"].map_id


class NetworkTest(RunningSystem):
    def label_the_start(self, *options):
        """Plays, and expects that tracking begins with labels in less than it would wait for them."""
        self.labels.clear()
        self.seen.keyframes.clear()
        self.seen.states.clear()
        play(rendered_bag(), "--duration", "2", *options)  # 8 s, less than init_wait_s
        self.seen.wait_for_tracking()
        self.assertEqual(self.labels[0].header.stamp, self.seen.keyframes[0].header.stamp,
                         "the first frame that was labelled is k1: people in it are known before it is tracked")

    def test_every_start_is_labelled(self):
        self.label_the_start()
        self.seen.wait_for_cloud(1)
        self.assertNotEqual(self.status["segmentation"].level, DiagnosticStatus.ERROR)
        self.assertEqual([entry.name for entry in self.label_info[-1].classes], ["background", "bright"])
        self.assertEqual({image.encoding for image in self.labels}, {"mono8"})
        self.assertTrue({image.header.stamp for image in self.overlays} <= {image.header.stamp for image in self.labels})
        self.assertTrue(self.overlays)
        first_map = self.map_id()
        self.label_the_start()  # the stamps go back
        self.wait_for_new_map(first_map)
        second_map = self.map_id()
        self.assertTrue(rospy.ServiceProxy("/slam_tracking/reset", Trigger)().success)
        self.label_the_start("--start", "2")
        self.wait_for_new_map(second_map)


class BrokenNetworkTest(RunningSystem):
    def test_goes_on_without_labels_and_says_so(self):
        self.assertEqual(self.status["segmentation"].level, DiagnosticStatus.ERROR)
        self.assertIn("network failed", self.status["segmentation"].message)
        play(rendered_bag())
        self.seen.wait_for_tracking()
        self.seen.wait_for_cloud(2000)
        self.assertEqual(self.labels, [])


if __name__ == "__main__":
    import rostest
    rostest.rosrun("semantic_vslam", "network_test", BrokenNetworkTest if "broken" in sys.argv else NetworkTest)

#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The semantic_vslam authors
# SPDX-License-Identifier: BSD-3-Clause
"""The robot runs what is measured: one recording through the nodelets, where nothing is dropped, and through run_offline."""
import json
import os
import subprocess
import tempfile
import time
import unittest

import cv2
import numpy
import rosbag
import rospy
from diagnostic_msgs.msg import DiagnosticArray
from programs import program
from semantic_vslam.msg import KeyframePoseArray, KeyframeStamped, TrackingReport
from sensor_msgs.msg import CameraInfo, Image
from slam_test import DEPTH_TOPIC, IMAGE_TOPIC, Recording, rendered_bag, wait_for_stages, wait_until
from std_srvs.srv import Trigger

INFO_TOPIC = "/camera/rgb/camera_info"
FRAMES = 60  # of the rendered recording; ~bag, ~frames, ~truth and ~model (of slam.launch, too) name others
REST_S = 0.15  # for what no message tells the end of: labels on their way


class PipelineTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        rospy.init_node("pipeline_test")
        cls.states, cls.keyframes, cls.removed = {}, {}, {}
        cls.adjusted = set()  # ids of keyframes
        cls.subscribers = [
            rospy.Subscriber("tracking/keyframe_poses", KeyframePoseArray,
                             lambda message: cls.adjusted.update(keyframe.id for keyframe in message.keyframes)),
            rospy.Subscriber("tracking/state", TrackingReport, cls.keep_state, queue_size=500),
            rospy.Subscriber("tracking/keyframe", KeyframeStamped, cls.keep, callback_args=cls.keyframes, queue_size=500),
            rospy.Subscriber("mapping/removed", Image, cls.keep, callback_args=cls.removed, queue_size=500)]
        cls.publishers = {topic: rospy.Publisher(topic, kind, queue_size=10)
                          for topic, kind in ((IMAGE_TOPIC, Image), (DEPTH_TOPIC, Image), (INFO_TOPIC, CameraInfo))}
        wait_for_stages("tracking", "motion", "mapping", *(["segmentation"] if rospy.get_param("~model") else []))
        cls.bag = rospy.get_param("~bag", "") or rendered_bag()
        cls.frames = rospy.get_param("~frames", FRAMES)
        cls.give_frames(cls.bag)
        cls.converted = cls.conversions()
        cls.out = tempfile.mkdtemp(dir=".")
        subprocess.check_call([program("run_offline"), cls.bag, "--out", cls.out, "--masks", "--frames", str(cls.frames),
                               "--set", "segmentation.model=" + rospy.get_param("~model")])

    @classmethod
    def keep_state(cls, message):
        if message.state not in (TrackingReport.WAITING, TrackingReport.PAUSED):  # those are of no frame
            cls.keep(message, cls.states)

    @classmethod
    def conversions(cls):
        counts = {}

        def on_diagnostics(message):
            for status in message.status:
                for value in status.values:
                    if value.key == "frames converted in this process":
                        counts[status.name] = int(value.value)

        subscriber = rospy.Subscriber("/diagnostics", DiagnosticArray, on_diagnostics)
        time.sleep(2.5)  # each nodelet reports once a second
        subscriber.unregister()
        return set(counts.values())

    @staticmethod
    def keep(message, by_stamp):
        by_stamp[message.header.stamp.to_nsec()] = message

    @classmethod
    def give_frames(cls, path):
        """One after the other, each when everything of the one before is done."""
        colours, depths = [], []
        with rosbag.Bag(path) as bag:
            cls.publishers[INFO_TOPIC].publish(next(bag.read_messages(INFO_TOPIC))[1])
            time.sleep(1.0)  # images that come before the calibration are of no use
            for topic, message, _ in bag.read_messages([IMAGE_TOPIC, DEPTH_TOPIC]):
                (colours if topic == IMAGE_TOPIC else depths).append(message)
                while colours and depths:
                    colour, depth = colours.pop(0), depths.pop(0)
                    depth.header.stamp = colour.header.stamp  # else the pair is known to be one when the next image comes
                    cls.publishers[IMAGE_TOPIC].publish(colour)
                    cls.publishers[DEPTH_TOPIC].publish(depth)
                    cls.wait_for(colour.header.stamp.to_nsec())
                    if len(cls.states) == cls.frames:
                        return

    @classmethod
    def wait_for(cls, stamp):
        wait_until(lambda: stamp in cls.states, 10, f"tracking of frame {stamp}")
        time.sleep(REST_S)
        wait_until(lambda: cls.keyframes.keys() <= cls.removed.keys(), 10, "mapping of the keyframes")
        wait_until(lambda: {keyframe.id for keyframe in cls.keyframes.values()} <= cls.adjusted, 10,
                   "the map's upkeep, after which the keyframes' poses are published")

    def offline_removed(self):
        """@return stamp in ns -> what run_offline left out of a keyframe's map"""
        folder = os.path.join(self.out, "removed")
        removed = {}
        for name in os.listdir(folder):
            seconds, decimals = name[:-len(".png")].split(".")
            stamp = int(seconds) * 10**9 + int(decimals.ljust(9, "0"))
            removed[stamp] = cv2.imread(os.path.join(folder, name), cv2.IMREAD_UNCHANGED)
        return removed

    def test_every_frame_is_tracked(self):
        self.assertEqual(len(self.states), self.frames)
        self.assertTrue(all(state.has_mask for state in self.states.values()))

    def test_a_frame_is_converted_once_for_all_nodelets(self):
        """Each tells the same count. A frame that all have let go and one asks for late is converted again."""
        self.assertEqual(len(self.converted), 1, self.converted)
        self.assertIn(self.converted.pop(), range(self.frames, round(1.1 * self.frames) + 1))

    def test_every_keyframe_loses_the_same_pixels(self):
        offline = self.offline_removed()
        common = offline.keys() & self.removed.keys()
        self.assertGreaterEqual(len(common), max(3, 0.9 * len(offline)), f"{sorted(offline)} {sorted(self.removed)}")
        different = {stamp: numpy.count_nonzero(Recording.pixels(self.removed[stamp]) != offline[stamp])
                     for stamp in sorted(common)}
        self.assertFalse(any(different.values()), f"pixels that differ, by keyframe: {different}")
        self.assertTrue(any((removed >= 128).any() for removed in offline.values()), "something is left out")

    def test_the_trajectories_are_as_good(self):
        self.assertTrue(rospy.ServiceProxy("/slam_tracking/save_trajectory", Trigger)().success)
        errors = [self.error_m(path) for path in ("trajectory.txt", os.path.join(self.out, "trajectory.txt"))]
        self.assertLess(abs(errors[0] - errors[1]), 0.05 * errors[1] + 1e-6, errors)

    def error_m(self, trajectory):
        truth = rospy.get_param("~truth", "") or self.truth()
        return json.loads(subprocess.check_output([program("evaluate_trajectory"), truth, trajectory,
                                                   "--json"]))["ate_m"]["rmse"]

    def truth(self):
        truth = os.path.join(self.out, "truth.txt")
        with rosbag.Bag(self.bag) as bag, open(truth, "w", encoding="utf-8") as file:
            for _, message, _ in bag.read_messages("/groundtruth/pose"):
                p, q = message.pose.position, message.pose.orientation
                stamp = message.header.stamp
                file.write(f"{stamp.secs}.{stamp.nsecs:09d} {p.x} {p.y} {p.z} {q.x} {q.y} {q.z} {q.w}\n")
        return truth


if __name__ == "__main__":
    import rostest
    rostest.rosrun("semantic_vslam", "pipeline_test", PipelineTest)

#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The semantic_vslam authors
# SPDX-License-Identifier: BSD-3-Clause
"""Kills the stages in turn, as a crash does: the others go on, and what was mapped is there again."""
import os
import signal
import sys
import time
import unittest
import xmlrpc.client

import numpy
import rosgraph
import rospkg
import rospy
from slam_test import Listener, Recording, play, rendered_bag, wait_for_stages, wait_until
from std_srvs.srv import SetBool, Trigger

WHOLE_AGAIN_S = 20  # 5 s on an idle machine; tests share theirs


class RecoveryTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        rospy.init_node("recovery_test")
        cls.nodelets = rospy.get_param("~nodelets")
        cls.recording = Recording(rendered_bag())
        wait_for_stages("tracking", "motion", "mapping")
        for name in ("map.slam", "map.dense"):  # of an earlier test: one that is larger would not be written over
            path = os.path.join(rospkg.get_ros_home(), "recovery_test", name)
            if os.path.exists(path):
                os.remove(path)
        cls.first = Listener()
        play(cls.recording.path)
        cls.first.wait_for_cloud(1000)
        time.sleep(4.0)  # the last keyframe on its way into the map
        cls.wait_until_kept()
        cls.keyframes, cls.points = cls.sizes()

    @classmethod
    def wait_until_kept(cls):
        """Until what was shown last is written: on a busy machine that rests for longer, as it took longer."""
        kept = os.path.join(rospkg.get_ros_home(), "semantic_vslam", "slam_mapping", "map.dense")
        deadline = time.monotonic() + 20
        while time.monotonic() < deadline and os.path.getmtime(kept) < cls.first.arrived["mapping/semantic_cloud"]:
            time.sleep(0.2)

    @classmethod
    def sizes(cls):
        """@return keyframes and points of the newest messages"""
        newest = cls.first.newest
        return (len(newest["tracking/keyframe_poses"].keyframes) if "tracking/keyframe_poses" in newest else 0,
                newest["mapping/semantic_cloud"].width if "mapping/semantic_cloud" in newest else 0)

    @staticmethod
    def pid(node):
        uri = rosgraph.Master("/recovery_test").lookupNode("/" + node)
        return xmlrpc.client.ServerProxy(uri).getPid("/recovery_test")[2]

    def kill(self, node, *topics):
        """Returns when the node has come back under another process. @param topics  that it has to send anew"""
        before = self.pid(node)
        for topic in topics:
            self.first.newest.pop(topic)
        os.kill(before, signal.SIGKILL)

        def is_back():
            try:
                return self.pid(node) != before
            except Exception:  # the master does not know it, or knows the dead one
                return False
        wait_until(is_back, WHOLE_AGAIN_S, f"the return of {node}")

    def check_map(self):
        def is_back():
            keyframes, points = self.sizes()
            return keyframes >= 0.95 * self.keyframes and points >= 0.95 * self.points

        try:
            wait_until(is_back, WHOLE_AGAIN_S, "the map's return")
        except AssertionError as error:
            raise AssertionError(f"{error}: keyframes, points {self.sizes()} of {(self.keyframes, self.points)}") from None

    def check_poses(self):
        """The recording once more: where the camera was then it is now, in the map that there was."""
        again = Listener()
        play(self.recording.path)
        wait_until(lambda: len(again.poses) > 0.7 * len(self.recording.stamps), 30, "tracking after the restart")
        both = sorted(again.poses.keys() & self.first.poses.keys())
        jumps = [numpy.linalg.norm(again.poses[s][:3, 3] - self.first.poses[s][:3, 3]) for s in both]
        self.assertLess(max(jumps), 0.05)

    def test_1_mapping(self):
        self.assertGreater(self.points, 1000)
        if self.nodelets:
            self.skipTest("one process")
        self.kill("slam_mapping", "mapping/semantic_cloud")
        self.check_map()

    def test_2_motion_and_segmentation_lose_nothing(self):
        if self.nodelets:
            self.skipTest("one process")
        self.kill("slam_motion")
        self.kill("slam_segmentation")
        self.check_map()

    def test_3_tracking(self):
        localize = rospy.ServiceProxy("/slam_tracking/localization_only", SetBool)
        self.assertTrue(localize(True).success)
        if self.nodelets:
            self.kill("slam_manager", "tracking/keyframe_poses", "mapping/semantic_cloud")
        else:
            self.kill("slam_tracking", "tracking/keyframe_poses")
        wait_for_stages("tracking", "motion", "mapping")
        self.check_map()
        self.first.keyframes.clear()
        self.check_poses()
        self.assertEqual(self.first.keyframes, [], "the one that came back localises only, too")
        self.check_map()
        answer = localize(False)
        self.assertTrue(answer.success)
        self.assertIn("mapping: the map of", answer.message)

    def test_4_a_map_is_saved_and_loaded_as_one(self):
        save, load = (rospy.ServiceProxy(f"/slam_tracking/{name}_map", Trigger) for name in ("save", "load"))
        self.assertTrue(save().success)
        wait_until(lambda: os.path.exists(os.path.join(self.folder(), "map.dense")), 10, "the dense map's file")
        self.assertTrue(rospy.ServiceProxy("/slam_tracking/reset", Trigger)().success)
        self.assertTrue(rospy.ServiceProxy("/slam_mapping/clear", Trigger)().success)
        wait_until(lambda: self.sizes() == (0, 0), 20, "an empty map")
        answer = load()
        self.assertTrue(answer.success, answer.message)
        self.check_map()

    def test_5_a_map_that_was_dropped_does_not_come_back(self):
        self.assertGreater(self.sizes()[0], 0)
        self.assertTrue(rospy.ServiceProxy("/slam_tracking/reset", Trigger)().success)
        wait_until(lambda: self.sizes()[0] == 0, 20, "an empty map")
        self.kill("slam_manager" if self.nodelets else "slam_tracking")  # before the next time that anything is kept
        wait_for_stages("tracking", "motion", "mapping")
        time.sleep(2.0)
        self.assertEqual(self.sizes()[0], 0)

    @staticmethod
    def folder():
        answer = rospy.ServiceProxy("/slam_mapping/save", Trigger)()
        return answer.message.split(" saved in ")[-1]


if __name__ == "__main__":
    import rostest
    rostest.rosrun("semantic_vslam", "recovery", RecoveryTest, sys.argv)

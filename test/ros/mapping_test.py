#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The semantic_vslam authors
# SPDX-License-Identifier: BSD-3-Clause
"""Names keyframes to the mapping node, which are placed at once or later, and looks where they are in the map."""
import struct
import time
import unittest

import rospy
import sensor_msgs.point_cloud2
from semantic_vslam.msg import KeyframePoseArray, KeyframeStamped, LabelDescription, LabelInfo
from sensor_msgs.msg import CameraInfo, Image, PointCloud2

WIDTH, HEIGHT, WALL_M = 64, 48, 2.0


def wait_until(condition, what, timeout_s=20):
    deadline = time.monotonic() + timeout_s
    while not condition():
        if rospy.is_shutdown() or time.monotonic() > deadline:
            raise AssertionError(f"{what} did not happen within {timeout_s} s")
        time.sleep(0.05)


def wall(stamp):
    """@return colour, depth and calibration of a camera that faces a wall"""
    rgb = Image(height=HEIGHT, width=WIDTH, encoding="rgb8", step=3 * WIDTH, data=bytes(3 * WIDTH * HEIGHT))
    depth = Image(height=HEIGHT, width=WIDTH, encoding="32FC1", step=4 * WIDTH,
                  data=struct.pack("<f", WALL_M) * (WIDTH * HEIGHT))
    info = CameraInfo(height=HEIGHT, width=WIDTH, distortion_model="plumb_bob", D=[0.0] * 5)
    info.K = [50, 0, 32, 0, 50, 24, 0, 0, 1]
    info.P = [50, 0, 32, 0, 0, 50, 24, 0, 0, 0, 1, 0]
    for message in (rgb, depth, info):
        message.header.stamp = stamp
        message.header.frame_id = "camera"
    return rgb, depth, info


def keyframe(number, stamp, placed, z_m=0.0):
    message = KeyframeStamped(id=number, map_id=1, placed=placed)
    message.header.stamp, message.header.frame_id = stamp, "map"
    message.pose.position.z = z_m
    message.pose.orientation.w = 1.0
    return message


class MappingTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        rospy.init_node("mapping_test")
        cls.cloud = None
        cls.subscriber = rospy.Subscriber("mapping/semantic_cloud", PointCloud2, cls.on_cloud)
        cls.images = [rospy.Publisher(topic, kind, queue_size=10)
                      for topic, kind in (("rgb/image_rect_color", Image), ("depth_registered/image_rect", Image),
                                          ("rgb/camera_info", CameraInfo))]
        cls.keyframes = rospy.Publisher("tracking/keyframe", KeyframeStamped, queue_size=10)
        cls.poses = rospy.Publisher("tracking/keyframe_poses", KeyframePoseArray, queue_size=10, latch=True)
        cls.labels = rospy.Publisher("segmentation/label_info", LabelInfo, queue_size=1)
        wait_until(lambda: all(p.get_num_connections() for p in (*cls.images, cls.keyframes, cls.poses, cls.labels)),
                   "the subscription of the mapping node")

    @classmethod
    def on_cloud(cls, message):
        cls.cloud = message

    @classmethod
    def distances(cls):
        """@return depths of the map's points, rounded to 0.1 m"""
        points = sensor_msgs.point_cloud2.read_points(cls.cloud, ("z",)) if cls.cloud else ()
        return {round(z, 1) for (z,) in points}

    @classmethod
    def publish_wall(cls, _=None):
        cls.stamp = rospy.Time.now()
        for publisher, message in reversed(list(zip(cls.images, wall(cls.stamp)))):
            publisher.publish(message)

    def name(self, number, placed):
        """Names the newest frame as a keyframe."""
        self.keyframes.publish(keyframe(number, self.stamp, placed))

    def place(self, *keyframes):
        poses = KeyframePoseArray(map_id=1, keyframes=keyframes)
        poses.header.frame_id = "map"
        self.poses.publish(poses)

    def test_a_keyframe_of_a_new_map_enters_when_that_is_joined(self):
        def first_is_there():
            self.name(1, placed=True)  # again and again: the node may not have had the calibration in time
            self.place(keyframe(1, self.stamp, placed=True))
            return self.distances() == {WALL_M}

        classes = LabelInfo(classes=[LabelDescription(name=name) for name in ("background", "chair")])
        self.labels.publish(classes)
        self.publish_wall()
        camera = rospy.Timer(rospy.Duration(0.05), self.publish_wall)
        wait_until(first_is_there, "the first keyframe in the map")
        for _ in range(3):
            self.name(2, placed=False)
            time.sleep(0.1)
        time.sleep(2.5)  # more frames than the node keeps
        camera.shutdown()
        self.assertEqual(self.distances(), {WALL_M})
        self.place(keyframe(1, self.stamp, placed=True), keyframe(2, self.stamp, placed=True, z_m=3.0))
        wait_until(lambda: self.distances() == {WALL_M, WALL_M + 3.0}, "the second one where it was placed")
        self.labels.publish(classes)
        time.sleep(1.0)  # ten publications
        self.assertEqual(self.distances(), {WALL_M, WALL_M + 3.0}, "the same classes again empty no map")


if __name__ == "__main__":
    import rostest
    rostest.rosrun("semantic_vslam", "mapping_test", MappingTest)

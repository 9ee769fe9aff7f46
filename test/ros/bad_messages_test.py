#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The semantic_vslam authors
# SPDX-License-Identifier: BSD-3-Clause
"""Sends messages that cannot be to live nodes: each costs itself alone, and is refused in one line with its topic."""
import os
import signal
import time
import unittest

import numpy
import rospy
from diagnostic_msgs.msg import DiagnosticArray
from faults_test import Node, camera_info, image
from semantic_vslam.msg import (KeyframePoseArray, KeyframeStamped, LabelDescription, LabelInfo, MotionReport,
                                TrackingReport)
from sensor_msgs.msg import CameraInfo, Image

WIDTH, HEIGHT = 64, 48
MODEL = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "data", "models", "tiny_labels.onnx")
NODES = ("motion_node", "tracking_node", "mapping_node", "segmentation_node")
TOPICS = {"rgb/image_rect_color": Image, "depth_registered/image_rect": Image, "rgb/camera_info": CameraInfo}
NAN, INF = float("nan"), float("inf")


def colour(stamp, **fields):
    message = image("rgb8", 3, stamp)
    message.data = numpy.random.RandomState(7).randint(0, 255, HEIGHT * WIDTH * 3, numpy.uint8).tobytes()
    return changed(message, fields)


def depth(stamp, **fields):
    message = image("32FC1", 4, stamp)
    message.data = numpy.full(HEIGHT * WIDTH, 1.5, numpy.float32).tobytes()
    return changed(message, fields)


def info(**fields):
    return changed(camera_info(50.0), fields)


def changed(message, fields):
    for name, value in fields.items():
        if name == "frame_id":
            message.header.frame_id = value
        else:
            setattr(message, name, value)
    return message


def of_size(width, height):
    """A pair and its calibration, consistent among themselves."""
    def messages(stamp):
        k = [50.0, 0, width / 2, 0, 50.0, height / 2, 0, 0, 1]
        p = [50.0, 0, width / 2, 0, 0, 50.0, height / 2, 0, 0, 0, 1, 0]
        return (colour(stamp, width=width, height=height, step=3 * width, data=bytes(3 * width * height)),
                depth(stamp, width=width, height=height, step=4 * width, data=bytes(4 * width * height)),
                info(width=width, height=height, K=k, P=p))
    return messages


def both(**fields):
    return lambda stamp: (colour(stamp, **fields), depth(stamp, **fields), info())


def calibrated(**fields):
    return lambda stamp: (colour(stamp), depth(stamp), info(**fields))


def projection(*values):
    fx, cx, fy, cy = values
    return calibrated(P=[fx, 0, cx, 0, 0, fy, cy, 0, 0, 0, 1, 0])


def stamped(seconds):
    stamp = rospy.Time(seconds, 999999999)
    return lambda _: (colour(stamp), depth(stamp), info())


def depths(value):
    data = numpy.full(HEIGHT * WIDTH, value, numpy.float32).tobytes()
    return lambda stamp: (colour(stamp), depth(stamp, data=data), info())


# What is sent in the place of a pair, and whether the log must name it.
PAIRS = {
    "1x1": (of_size(1, 1), True), "8x8": (of_size(8, 8), True), "2000x1": (of_size(2000, 1), True),
    "1x2000": (of_size(1, 2000), True), "24x24": (of_size(24, 24), True), "0x0": (of_size(0, 0), True),
    "camera of 30000x30000": (calibrated(width=30000, height=30000), True),
    "camera of another size": (calibrated(width=640, height=480), True),
    "camera of 2^32 - 1": (calibrated(width=2**32 - 1, height=2**32 - 1), True),
    "height x step beyond 32 bits": (both(height=4194305, step=1024, data=bytes(1024)), True),
    "width of 2^31 + 64": (both(width=2**31 + 64), True),
    "data that end early": (both(data=bytes(100)), True), "no data": (both(data=b""), True),
    "step too small": (both(step=1, data=bytes(HEIGHT)), True), "step of 0": (both(step=0), True),
    "colour in an unknown encoding": (lambda s: (colour(s, encoding="foo"), depth(s), info()), True),
    "an encoding that rules terminals": (lambda s: (colour(s, encoding="x\x1b[2J\n"), depth(s), info()), True),
    "depth without an encoding": (lambda s: (colour(s), depth(s, encoding=""), info()), True),
    "colour in place of depth": (lambda s: (colour(s), colour(s), info()), True),
    "depth of another size": (lambda s: (colour(s), of_size(32, 32)(s)[1], info()), True),
    "depth all NaN": (depths(NAN), False), "depth all infinite": (depths(INF), False),
    "depth of -1": (depths(-1), False), "depth of 1e30": (depths(1e30), False),
    "big-endian": (both(is_bigendian=1), False),
    "focal length NaN": (projection(NAN, 32, 50, 24), True), "focal length 1e-300": (projection(1e-300, 32, 1e-300, 24), True),
    "focal length 1e300": (projection(1e300, 32, 1e300, 24), True), "focal length -50": (projection(-50, 32, -50, 24), True),
    "principal point -1e9": (projection(50, -1e9, 50, 24), True), "principal point infinite": (projection(50, INF, 50, 24), True),
    "no frame_id": (both(frame_id=""), False), "a frame_id of 100 kB": (both(frame_id="x" * 100000), False),
    "stamp 0": (lambda _: (colour(rospy.Time(0)), depth(rospy.Time(0)), info()), False),
    "stamp 1": (stamped(1), False), "stamp 2^31": (stamped(2**31), False), "stamp 2^32 - 1": (stamped(2**32 - 1), False),
}


def others(stamp):
    """Name -> topic, message: what the stages tell each other, and what another program may."""
    pose = KeyframeStamped(id=2**64 - 1, map_id=2**32 - 1, placed=True)
    pose.header.stamp = stamp
    pose.pose.position.x, pose.pose.position.y = NAN, 1e300
    far = KeyframeStamped(id=7, map_id=1, placed=True)
    far.pose.orientation.w = 1
    far.pose.position.x = 3e7
    report = MotionReport(model=200, inliers=2**32 - 1, dynamic_share=NAN)
    report.header.stamp = stamp
    report.moving = colour(stamp, data=b"123")
    state = TrackingReport(state=TrackingReport.OK)
    state.header.stamp = stamp
    state.camera.position.x = NAN
    small = image("mono8", 1, stamp)
    small.width = small.height = small.step = 1
    small.data = b"\xff"
    return {
        "mask of 1x1": ("motion/mask", small), "labels of 1x1": ("segmentation/labels", small),
        "mask in colour": ("motion/mask", colour(stamp)), "labels in colour": ("segmentation/labels", colour(stamp)),
        "mask beyond 32 bits": ("motion/mask", changed(image("mono8", 1, stamp), {"height": 4194305, "step": 1024,
                                                                                 "data": bytes(1024)})),
        "report without sense": ("motion/report", report),
        "1000 classes": ("segmentation/label_info", LabelInfo(classes=[LabelDescription(name="x", mobility=99)] * 1000)),
        "no classes": ("segmentation/label_info", LabelInfo()),
        "pose of NaN": ("tracking/keyframe_poses", KeyframePoseArray(map_id=1, keyframes=[pose, far])),
        "keyframe of NaN": ("tracking/keyframe", pose), "keyframe far away": ("tracking/keyframe", far),
        "state of NaN": ("tracking/state", state),
    }


class BadMessagesTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        rospy.init_node("bad_messages_test")
        cls.publishers = {topic: rospy.Publisher(topic, kind, queue_size=20) for topic, kind in TOPICS.items()}
        cls.reports, cls.refused = [], {}
        cls.subscribers = [rospy.Subscriber("motion/report", MotionReport, cls.reports.append, queue_size=50),
                           rospy.Subscriber("/diagnostics", DiagnosticArray, cls.on_diagnostics)]
        cls.nodes = {name: Node(name, f"__name:={name}", "_input/max_interval_s:=0.02",
                                *([f"_segmentation/model:={MODEL}"] if "segmentation" in name else [])) for name in NODES}
        cls.wait(lambda: all(p.get_num_connections() >= len(NODES) for p in cls.publishers.values()), "a connection")

    @classmethod
    def tearDownClass(cls):
        for node in cls.nodes.values():
            node.__exit__()

    @classmethod
    def on_diagnostics(cls, message):
        for status in message.status:
            counts = [int(value.value) for value in status.values if value.key.endswith("refused")]
            cls.refused[status.name] = sum(counts)

    @classmethod
    def wait(cls, condition, what, timeout_s=40):
        deadline = time.monotonic() + timeout_s
        while not condition():
            cls.check_alive(what)
            if time.monotonic() > deadline:
                raise AssertionError(f"no {what} within {timeout_s} s: {cls.log()}")
            time.sleep(0.05)

    @classmethod
    def log(cls):
        return "".join("".join(node.lines[-20:]) for node in cls.nodes.values())

    @classmethod
    def check_alive(cls, after):
        for name, node in cls.nodes.items():
            if node.process.poll() is not None:
                raise AssertionError(f"{name} ended after {after}: {''.join(node.lines[-20:])}")

    def send(self, messages):
        rgb, depth_image, calibration = messages
        self.publishers["rgb/camera_info"].publish(calibration)
        time.sleep(0.05)  # the calibration comes first
        self.publishers["rgb/image_rect_color"].publish(rgb)
        self.publishers["depth_registered/image_rect"].publish(depth_image)

    def send_good(self, after):
        """Until a frame has gone its way through motion detection."""
        count = len(self.reports)
        deadline = time.monotonic() + 40
        while len(self.reports) < count + 2:
            self.check_alive(after)
            self.assertLess(time.monotonic(), deadline, f"frames that are good are not taken after {after}: {self.log()}")
            stamp = rospy.Time.now()
            self.send((colour(stamp), depth(stamp), info()))
            time.sleep(0.05)

    def test_1_a_pair_that_cannot_be_costs_itself_alone(self):
        self.send_good("the start")
        for name, (messages, is_said) in PAIRS.items():
            with self.subTest(name):
                lines = len(self.nodes["motion_node"].lines_with("refused"))
                for _ in range(2):
                    self.send(messages(rospy.Time.now()))
                if is_said:
                    self.wait(lambda: len(self.nodes["motion_node"].lines_with("refused")) > lines, f"line on {name}", 5)
                self.send_good(name)

    def test_2_what_stages_tell_each_other_may_be_wrong(self):
        kinds = {topic: type(message) for topic, message in others(rospy.Time.now()).values()}
        publishers = {topic: rospy.Publisher(topic, kind, queue_size=5) for topic, kind in kinds.items()}
        self.wait(lambda: all(p.get_num_connections() > 0 for p in publishers.values()), "a connection")
        for name, (topic, _) in others(rospy.Time.now()).items():
            with self.subTest(name):
                publishers[topic].publish(others(rospy.Time.now())[name][1])
                self.send_good(name)

    def test_3_refusals_are_counted_and_said_in_lines_of_their_own(self):
        self.wait(lambda: len([count for count in self.refused.values() if count > 0]) >= len(NODES), "count of refusals")
        for name, node in self.nodes.items():
            self.assertEqual(node.lines_with("FATAL"), [], name)
            self.assertFalse(any("\x1b[2J" in line for line in node.lines), name)

    def test_4_nodes_end_in_peace(self):
        for node in self.nodes.values():
            node.process.send_signal(signal.SIGINT)
        for name, node in self.nodes.items():
            self.assertEqual(node.process.wait(40), 0, name)


if __name__ == "__main__":
    import rostest
    rostest.rosrun("semantic_vslam", "bad_messages_test", BadMessagesTest)

#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The semantic_vslam authors
# SPDX-License-Identifier: BSD-3-Clause
"""Starts single nodes with faulty settings and inputs and checks what they say of it."""
import os
import subprocess
import tempfile
import threading
import time
import unittest

import rospy
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from programs import program
from sensor_msgs.msg import CameraInfo, Image


class Node:
    """One node of the package as a process, with what it wrote so far."""

    def __init__(self, name, *arguments):
        self.process = subprocess.Popen([program(name), *arguments], stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                                        text=True)
        self.lines = []
        self.reader = threading.Thread(target=self.read, daemon=True)
        self.reader.start()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.terminate()
        self.process.wait(20)

    def read(self):
        for line in self.process.stdout:
            self.lines.append(line)

    def lines_with(self, *words):
        return [line for line in self.lines if all(word in line for word in words)]

    def wait_for_line(self, *words, timeout_s=40):
        deadline = time.monotonic() + timeout_s
        while not self.lines_with(*words):
            if time.monotonic() > deadline:
                raise AssertionError(f"no line with {words} within {timeout_s} s, only: {''.join(self.lines)}")
            time.sleep(0.1)


def image(encoding, pixel_bytes, stamp):
    message = Image(height=48, width=64, encoding=encoding, step=64 * pixel_bytes)
    message.header.stamp = stamp
    message.header.frame_id = "camera"
    message.data = bytes(48 * message.step)
    return message


def camera_info(focal_px):
    info = CameraInfo(height=48, width=64, distortion_model="plumb_bob", D=[0.0] * 5)
    info.K = [focal_px, 0, 32, 0, focal_px, 24, 0, 0, 1]
    info.P = [focal_px, 0, 32, 0, 0, focal_px, 24, 0, 0, 0, 1, 0]
    return info


class Camera:
    """Publishes pairs on the nodes' own topic names until stopped."""

    def __init__(self, rgb="rgb8", depth="16UC1", focal_px=50.0, stamped=True, depth_late_s=0.0, depth_frame="camera",
                 depth_ends=float("inf")):
        self.stamped, self.depth_late, self.depth_frame = stamped, rospy.Duration(depth_late_s), depth_frame
        self.depth_left = depth_ends
        self.rgb = rospy.Publisher("rgb/image_rect_color", Image, queue_size=2)
        self.depth = rospy.Publisher("depth_registered/image_rect", Image, queue_size=2)
        self.info = rospy.Publisher("rgb/camera_info", CameraInfo, queue_size=2)
        self.encodings, self.focal_px = (rgb, depth), focal_px
        self.timer = rospy.Timer(rospy.Duration(0.1), self.tick)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.timer.shutdown()
        for publisher in (self.rgb, self.depth, self.info):
            publisher.unregister()

    def tick(self, _):
        stamp = rospy.Time.now() if self.stamped else rospy.Time()
        sizes = {"rgb8": 3, "bayer_rggb16": 2, "16UC1": 2, "mono8": 1}
        self.rgb.publish(image(self.encodings[0], sizes[self.encodings[0]], stamp))
        depth = image(self.encodings[1], sizes[self.encodings[1]], stamp + self.depth_late)
        depth.header.frame_id = self.depth_frame
        self.depth_left -= 1
        if self.depth_left >= 0:
            self.depth.publish(depth)
        if self.focal_px is not None:
            self.info.publish(camera_info(self.focal_px))


class FaultsTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        rospy.init_node("faults_test")

    def check_refused_start(self, name, arguments, *words):
        with Node(name, *arguments) as node:
            self.assertEqual(node.process.wait(40), 1)
            node.reader.join(5)
            self.assertEqual(len(node.lines_with("FATAL", *words)), 1, "".join(node.lines))

    def test_unknown_parameter_is_named(self):
        self.check_refused_start("motion_node", ["__name:=a", "_motion/homography/thetta_px:=4"],
                                 "motion.homography.thetta_px")

    def test_parameter_out_of_range_is_named_with_its_bounds(self):
        self.check_refused_start("mapping_node", ["__name:=b", "_dense/voxels/resolution_m:=-1"],
                                 "dense.voxels.resolution_m", "[0.005, 1]")

    def test_missing_camera_file_is_named(self):
        self.check_refused_start("motion_node", ["__name:=c", "_input/camera_file:=/nowhere/camera.yaml"],
                                 "/nowhere/camera.yaml")

    def test_missing_config_file_is_named(self):
        self.check_refused_start("tracking_node", ["__name:=d", "_config_file:=/nowhere/slam.yaml"],
                                 "/nowhere/slam.yaml")

    def test_unknown_section_of_the_config_file_is_named(self):
        with tempfile.NamedTemporaryFile("w", suffix=".yaml") as file:
            file.write("motoin: {model: none}\n")
            file.flush()
            self.check_refused_start("motion_node", ["__name:=e", "_config_file:=" + file.name], "motoin")

    def test_one_file_serves_all_nodes_and_parameters_hold_over_it(self):
        with tempfile.NamedTemporaryFile("w", suffix=".yaml") as file:
            file.write("input: {silent_after_s: 0.5, queue_size: 9}\npeople.keep_s: 2\nlabels_wait_s: 4\nframes.tf_wait_s: 0.1\n")
            file.flush()
            for name in ("motion_node", "tracking_node", "mapping_node"):
                with Node(name, "__name:=shared_" + name, "_config_file:=" + file.name, "_input/queue_size:=3") as node:
                    node.wait_for_line("WARN", "no message yet on")
                    self.assertEqual(len(node.lines_with("WARN", file.name, "input.queue_size: 9", "'3'")), 1)
                    self.assertEqual(len(node.lines_with(file.name)), 1)

    def test_localisation_only_needs_a_map(self):
        self.check_refused_start("tracking_node", ["__name:=lone", "_localization_only:=true"], "no map to localise in", "map:=DIR")

    def test_odometry_frame_without_base_frame_is_refused(self):
        self.check_refused_start("tracking_node", ["__name:=f", "_frames/odom_frame:=odom"], "base_frame")

    def test_unknown_image_transport_is_named(self):
        for name in ("motion_node", "tracking_node", "mapping_node"):
            self.check_refused_start(name, ["__name:=m", "_image_transport:=smoke"], "image_transport", "smoke")

    def test_share_that_segmentation_does_not_decide_by_is_refused(self):
        self.check_refused_start("segmentation_node", ["__name:=n", "_segmentation/phi:=0.5"], "segmentation.phi")

    def test_missing_transform_is_named_in_the_diagnostics(self):
        problems = []

        def on_diagnostics(message):
            problems.extend(status.message for status in message.status if status.level == DiagnosticStatus.WARN)

        diagnostics = rospy.Subscriber("/diagnostics", DiagnosticArray, on_diagnostics)
        with Camera(), Node("tracking_node", "__name:=o", "_frames/base_frame:=base_link") as node:
            node.wait_for_line("WARN", "camera -> base_link")
            deadline = time.monotonic() + 20
            while not any("base_link" in problem for problem in problems):
                self.assertLess(time.monotonic(), deadline, problems)
                time.sleep(0.1)
        diagnostics.unregister()

    def test_unreadable_model_costs_the_labels_only(self):
        with tempfile.TemporaryDirectory() as folder:
            model = os.path.join(folder, "broken.onnx")
            with open(model, "wb") as file:
                file.write(b"not a network")
            with Node("segmentation_node", "__name:=g", "_segmentation/model:=" + model) as node:
                node.wait_for_line("ERROR", "broken", "without labels")
                self.assertIsNone(node.process.poll())

    def test_silent_inputs_are_named_as_resolved(self):
        with Node("motion_node", "__name:=h", "_input/silent_after_s:=0.5", "rgb/camera_info:=/front/info") as node:
            node.wait_for_line("WARN", "/rgb/image_rect_color", "/depth_registered/image_rect", "/front/info")

    def test_missing_camera_info_alone_is_named(self):
        with Camera(focal_px=None), Node("motion_node", "__name:=i", "_input/silent_after_s:=3.0") as node:
            node.wait_for_line("WARN", "/rgb/camera_info")
            self.assertEqual(node.lines_with("no message yet on", "/rgb/image_rect_color"), [])

    def test_uncalibrated_camera_is_said(self):
        with Camera(focal_px=0.0), Node("motion_node", "__name:=j") as node:
            node.wait_for_line("ERROR", "uncalibrated")

    def test_wrong_encodings_are_named(self):
        with Camera(rgb="bayer_rggb16"), Node("motion_node", "__name:=k") as node:
            node.wait_for_line("ERROR", "colour image", "bayer_rggb16")
        with Camera(depth="mono8"), Node("motion_node", "__name:=l") as node:
            node.wait_for_line("ERROR", "depth image", "mono8")

    def test_images_without_stamps_are_refused(self):
        with Camera(stamped=False), Node("motion_node", "__name:=unstamped") as node:
            node.wait_for_line("ERROR", "header.stamp is not set")
            node.wait_for_line("WARN", "have no header.stamp")
            self.assertEqual(node.lines_with("max_interval_s"), [])

    def test_depth_that_is_not_registered_is_doubted(self):
        with Camera(depth_frame="depth"), Node("motion_node", "__name:=unregistered") as node:
            node.wait_for_line("WARN", "frame_id is 'depth'", "registered to colour")

    def test_the_stream_that_ends_is_named(self):
        with Node("motion_node", "__name:=silent", "_input/silent_after_s:=1.0") as node:
            node.wait_for_line("WARN", "no message yet on")
            with Camera(depth_ends=30):
                node.wait_for_line("WARN", "no image any more on /depth_registered/image_rect")
            self.assertEqual(node.lines_with("no image any more on /rgb/image_rect_color and"), [])

    def test_an_offset_asks_for_approximate_pairs(self):
        with Camera(depth_late_s=0.005), Node("motion_node", "__name:=offset", "_input/sync:=exact",
                                              "_input/silent_after_s:=3.0") as node:
            node.wait_for_line("WARN", "sync:=approximate")


if __name__ == "__main__":
    import rostest
    rostest.rosrun("semantic_vslam", "faults_test", FaultsTest)

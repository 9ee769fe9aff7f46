#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The semantic_vslam authors
# SPDX-License-Identifier: BSD-3-Clause
"""The topics and services of the running nodes are those of doc/nodes.md, with the same types."""
import os
import re
import unittest

import rosgraph
import rospy
import rosservice
from diagnostic_msgs.msg import DiagnosticArray
from programs import program  # noqa: F401  mends Debian 11's threads
from slam_test import wait_until

PAGE = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "doc", "nodes.md")
REMAPPED = {"rgb/image_rect_color": "/camera/rgb/image_color", "depth_registered/image_rect": "/camera/depth/image",
            "rgb/camera_info": "/camera/rgb/camera_info"}
LABELLING = "/with_network"  # a namespace with a segmentation node whose network loads
# Each node's by roscpp.
IGNORED_TOPICS, IGNORED_SERVICES = {"/rosout", "/clock"}, {"~get_loggers", "~set_logger_level"}


def documented():
    """@return node -> (published, subscribed, services), each {name: type} as on the page"""
    with open(PAGE, encoding="utf-8") as file:
        sections = re.split(r"^## ", file.read(), flags=re.M)
    nodes = {}
    for section in sections:
        title = section.split("\n", 1)[0]
        if not title.startswith("slam_"):
            continue
        topics = re.findall(r"^\| (in|out) \| `(\S+)` \| (\S+) \|", section, flags=re.M)
        services = re.findall(r"^\| `(~\S+)` \| (\w+/\w+) \|", section, flags=re.M)
        kinds = {name: kind if "/" in kind else "semantic_vslam/" + kind for _, name, kind in topics}
        nodes[title] = tuple({name: kinds[name] for way, name, _ in topics if way == wanted} for wanted in ("out", "in")) + (
            dict(services),)
    return nodes


def resolved(names):
    return {REMAPPED.get(name, name if name.startswith("/") else "/" + name): kind for name, kind in names.items()}


class InterfaceTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        rospy.init_node("interface_test")
        cls.master = rosgraph.Master("/interface_test")
        cls.page = documented()
        cls.network_failed = False
        diagnostics = rospy.Subscriber("/diagnostics", DiagnosticArray, cls.on_diagnostics)
        rospy.wait_for_service("/slam_tracking/save_map", 60)
        rospy.wait_for_service("/slam_mapping/save", 60)
        wait_until(lambda: cls.network_failed or "/motion/report" in cls.names(0, "/slam_motion") and
                   LABELLING + "/segmentation/labels" in cls.names(0, LABELLING + "/slam_segmentation"), 60, "the start of the nodes")
        diagnostics.unregister()

    @classmethod
    def on_diagnostics(cls, message):
        cls.network_failed |= any("with_network" in status.name and "network failed" in status.message for status in message.status)

    @classmethod
    def names(cls, what, node):
        """@param what  0 published, 1 subscribed, 2 services"""
        return {name for name, nodes in cls.master.getSystemState()[what] if node in nodes}

    # No subTest here: rosunit loses what fails in one.

    def differences(self, node, live):
        """@param live  what the node publishes and subscribes to  @return one line for each difference from the page"""
        kinds = dict(self.master.getTopicTypes())
        lines = []
        for what, way in enumerate(("published", "subscribed to")):
            written, names = resolved(self.page[node][what]), live[what] - IGNORED_TOPICS
            lines += [f"{name} is {way} by {node} and not in doc/nodes.md" for name in sorted(names - set(written))]
            lines += [f"{name} is in doc/nodes.md and not {way} by {node}" for name in sorted(set(written) - names)]
            for name in names & set(written):
                kind = kinds.get(name) or kinds[LABELLING + name]
                if kind != written[name]:
                    lines.append(f"{name} is {kind}, {written[name]} in doc/nodes.md")
        return lines

    def test_topics(self):
        self.assertEqual([], [line for node in ("slam_motion", "slam_tracking", "slam_mapping")
                              for line in self.differences(node, [self.names(what, "/" + node) for what in (0, 1)])])

    def test_topics_with_a_network(self):
        if self.network_failed:
            self.skipTest("a build without ONNX Runtime")

        def local(name):
            name = name[len(LABELLING):] if name.startswith(LABELLING) else name
            return REMAPPED.get(name.lstrip("/"), name)

        live = [{local(name) for name in self.names(what, LABELLING + "/slam_segmentation")} for what in (0, 1)]
        self.assertEqual([], self.differences("slam_segmentation", live))
        self.assertEqual(self.names(0, "/slam_segmentation") - IGNORED_TOPICS, {"/segmentation/label_info", "/diagnostics"})
        self.assertEqual(self.names(1, "/slam_segmentation") - IGNORED_TOPICS, set())

    def test_services(self):
        self.assertEqual(set(self.page), {"slam_motion", "slam_tracking", "slam_segmentation", "slam_mapping"})
        for node, (_, _, written) in self.page.items():
            live = {name.replace(f"/{node}/", "~", 1): rosservice.get_service_type(name) for name in self.names(2, "/" + node)}
            self.assertEqual({name: kind for name, kind in live.items() if name not in IGNORED_SERVICES}, written, node)


if __name__ == "__main__":
    import rostest
    rostest.rosrun("semantic_vslam", "interface", InterfaceTest)

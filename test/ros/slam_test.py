#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The semantic_vslam authors
# SPDX-License-Identifier: BSD-3-Clause
"""Plays a small rendered recording with walking people through the running system and checks what comes out."""
import collections
import os
import subprocess
import time
import unittest

import cv2
import numpy
import rosbag
import rospkg
import rospy
import sensor_msgs.point_cloud2
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import Point, PoseWithCovarianceStamped, TransformStamped
from nav_msgs.msg import OccupancyGrid, Odometry, Path
from nav_msgs.srv import GetMap
from octomap_msgs.msg import Octomap
from octomap_msgs.srv import BoundingBoxQuery, GetOctomap
from programs import program
from rosgraph_msgs.msg import Log
from semantic_vslam.msg import KeyframePoseArray, KeyframeStamped, MotionReport, MoverArray, ObjectArray, TrackingReport
from sensor_msgs.msg import CameraInfo, Image, PointCloud2
from std_srvs.srv import Empty, SetBool, Trigger
from tf import transformations
from tf2_msgs.msg import TFMessage
from visualization_msgs.msg import Marker, MarkerArray

CAMERA_FRAME = "openni_rgb_optical_frame"
IMAGE_TOPIC, DEPTH_TOPIC = "/camera/rgb/image_color", "/camera/depth/image"


def matrix(translation, rotation):
    """Pose as a 4 x 4 matrix."""
    out = transformations.quaternion_matrix([rotation.x, rotation.y, rotation.z, rotation.w])
    out[:3, 3] = [translation.x, translation.y, translation.z]
    return out


def static_edge(text):
    """@param text  x y z yaw pitch roll, as static_transform_publisher takes them"""
    x, y, z, yaw, pitch, roll = map(float, text.split())
    return transformations.compose_matrix(translate=(x, y, z), angles=(roll, pitch, yaw))


def wait_until(condition, timeout_s, what):
    deadline = time.monotonic() + timeout_s
    while not condition():
        if rospy.is_shutdown() or time.monotonic() > deadline:
            raise AssertionError(f"{what} did not happen within {timeout_s} s")
        time.sleep(0.1)


def wait_for_stages(*stages):
    """Until each has reported: by then it has subscribed to what it takes."""
    reported = set()

    def on_diagnostics(message):
        reported.update(status.name.split()[-1] for status in message.status)

    subscriber = rospy.Subscriber("/diagnostics", DiagnosticArray, on_diagnostics)
    wait_until(lambda: reported.issuperset(stages), 60, f"a report of {', '.join(stages)}")
    subscriber.unregister()


def rendered_bag():
    """Four seconds of a room with walking people; kept until the program that renders it is newer."""
    renderer = program("make_synthetic_bag")
    path = os.path.join(rospkg.get_ros_home(), "semantic_vslam_test_room.bag")
    if not os.path.isfile(path) or os.path.getmtime(path) < os.path.getmtime(renderer):
        subprocess.check_call([renderer, "--out", path, "--size", "320x240", "--seconds", "4"])
    return path


class Recording:
    """The rendered bag and what is true in it."""

    def __init__(self, path):
        self.path = path
        self.poses = {}  # stamp in ns -> T_world_camera
        self.stamps, self.depth_m, self.masks = [], {}, {}
        with rosbag.Bag(path) as bag:
            for topic, message, _ in bag.read_messages():
                if topic == "/groundtruth/pose":
                    pose = matrix(message.pose.position, message.pose.orientation)
                    self.poses[message.header.stamp.to_nsec()] = pose
                elif topic == IMAGE_TOPIC:
                    self.stamps.append(message.header.stamp.to_nsec())
                elif topic == DEPTH_TOPIC:
                    depth = numpy.frombuffer(message.data, numpy.float32).reshape(message.height, message.width)
                    self.depth_m[message.header.stamp.to_nsec()] = numpy.nan_to_num(depth)
                elif topic == "/groundtruth/mask":
                    self.masks[message.header.stamp.to_nsec()] = self.pixels(message) >= 128
                elif topic == "/camera/rgb/camera_info":
                    self.K = numpy.array(message.K).reshape(3, 3)

    def first(self, kinds):
        """@param kinds  topic -> type  @return topic -> its first message"""
        with rosbag.Bag(self.path) as bag:
            recorded = {topic: next(bag.read_messages(topic))[1] for topic in kinds}
        return {topic: kind(*(getattr(recorded[topic], slot) for slot in kind.__slots__))
                for topic, kind in kinds.items()}

    @staticmethod
    def pixels(message):
        return numpy.frombuffer(message.data, numpy.uint8).reshape(message.height, message.width)


class Listener:
    def __init__(self):
        self.states, self.idle, self.poses, self.transforms, self.masks = [], [], {}, {}, {}
        self.log, self.arrived = [], {}  # topic -> when its newest message came, s
        self.health = collections.defaultdict(list)  # stage -> messages of the diagnostics
        self.keyframes, self.newest, self.odometry, self.motion, self.people = [], {}, [], [], []
        self.subscribers = [
            rospy.Subscriber("tracking/state", TrackingReport, self.on_state, queue_size=500),
            rospy.Subscriber("tracking/pose", PoseWithCovarianceStamped, self.on_pose, queue_size=500),
            rospy.Subscriber("tracking/keyframe", KeyframeStamped, self.keyframes.append, queue_size=500),
            rospy.Subscriber("tracking/odometry", Odometry, self.odometry.append, queue_size=500),
            rospy.Subscriber("motion/report", MotionReport, self.motion.append, queue_size=500),
            rospy.Subscriber("people", MoverArray, self.people.append, queue_size=500),
            rospy.Subscriber("motion/mask", Image, self.on_mask, queue_size=500),
            rospy.Subscriber("/diagnostics", DiagnosticArray, self.on_diagnostics, queue_size=500),
            rospy.Subscriber("/rosout", Log, lambda message: self.log.append(message.msg), queue_size=500),
            rospy.Subscriber("/tf", TFMessage, self.on_tf, queue_size=500)]
        for topic, kind in (("tracking/keyframe_poses", KeyframePoseArray), ("mapping/semantic_cloud", PointCloud2),
                            ("mapping/octomap_binary", Octomap), ("mapping/octomap_full", Octomap),
                            ("mapping/projected_map", OccupancyGrid), ("mapping/object_markers", MarkerArray), ("mapping/objects", ObjectArray),
                            ("tracking/path", Path), ("tracking/points", PointCloud2), ("motion/flow_image", Image)):
            self.subscribers.append(rospy.Subscriber(topic, kind, self.keep, callback_args=topic, queue_size=1))

    def keep(self, message, topic):
        self.newest[topic], self.arrived[topic] = message, time.time()

    def wait_for_cloud(self, least_points):
        """An empty one is sent to whoever subscribes."""
        wait_until(lambda: "mapping/semantic_cloud" in self.newest and
                   self.newest["mapping/semantic_cloud"].width >= least_points, 30, "a semantic cloud")

    def wait_for_tracking(self):
        wait_until(lambda: self.states and self.states[-1].state == TrackingReport.OK, 20, "tracking")

    def on_state(self, message):
        """Reports of frames, and those that say that there are none."""
        (self.idle if message.state in (TrackingReport.WAITING, TrackingReport.PAUSED) else self.states).append(message)

    def on_diagnostics(self, message):
        for status in message.status:
            self.health[status.name.split()[-1]].append(status.message)

    def on_pose(self, message):
        pose = message.pose.pose
        self.poses[message.header.stamp.to_nsec()] = matrix(pose.position, pose.orientation)

    def on_mask(self, message):
        self.masks[message.header.stamp.to_nsec()] = (message.header.frame_id, Recording.pixels(message) >= 128)

    def on_tf(self, message):
        for edge in message.transforms:
            if edge.header.frame_id == "map":
                pose = matrix(edge.transform.translation, edge.transform.rotation)
                self.transforms[edge.header.stamp.to_nsec()] = (edge.child_frame_id, pose)


def play(path, *options):
    """Plays to the end, at a quarter of the speed: what is tested is the result, not this machine."""
    subprocess.check_call(["rosbag", "play", "--clock", "--quiet", "--rate", "0.25", *options, path,
                           "--topics", IMAGE_TOPIC, DEPTH_TOPIC, "/camera/rgb/camera_info"])


def aligned_error_m(estimate, truth):
    """Absolute trajectory error after the best rigid alignment (Horn), RMSE. @param estimate, truth N x 3"""
    a, b = estimate - estimate.mean(0), truth - truth.mean(0)
    u, _, vt = numpy.linalg.svd(b.T @ a)
    flip = numpy.diag([1, 1, numpy.sign(numpy.linalg.det(u @ vt))])
    return numpy.sqrt((((u @ flip @ vt @ a.T).T - b) ** 2).sum(1).mean())


class SlamTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        rospy.init_node("slam_test")
        cls.body_frame = rospy.get_param("~base_frame", CAMERA_FRAME)
        cls.body_camera = static_edge(rospy.get_param("~base_camera", "0 0 0 0 0 0"))
        cls.odom_body = static_edge(rospy.get_param("~odom_base", "0 0 0 0 0 0"))
        cls.recording = Recording(rendered_bag())
        cls.seen = Listener()
        for service in ("/slam_tracking/save_trajectory", "/slam_mapping/save"):
            rospy.wait_for_service(service, 60)
        cls.processes = 3 if rospy.get_param("~nodes", False) else 1  # that take images
        master = rospy.get_master()

        def ready():
            subscribed = dict(master.getSystemState()[2][1])
            # The segmentation stage is idle without a network and takes no images.
            return all(len(subscribed.get(topic, [])) >= cls.processes for topic in (IMAGE_TOPIC, DEPTH_TOPIC))

        wait_until(ready, 60, "the subscription of the stages to the images")
        wait_for_stages("tracking", "motion", "mapping")
        play(cls.recording.path)
        wait_until(lambda: len(cls.seen.states) >= 0.9 * len(cls.recording.stamps), 60, "tracking of the recording")
        cls.seen.wait_for_cloud(1)
        time.sleep(3.0)  # the last keyframe on its way into the map

    def camera_pose(self, stamp):
        """@return T_map_camera of what is published: T_map_body"""
        return self.seen.poses[stamp] @ self.body_camera

    def test_1_almost_every_frame_has_a_pose_near_the_truth(self):
        posed = sorted(self.seen.poses.keys() & self.recording.poses.keys())
        self.assertGreaterEqual(len(posed), 0.9 * len(self.recording.stamps))
        estimate = numpy.array([self.camera_pose(stamp)[:3, 3] for stamp in posed])
        truth = numpy.array([self.recording.poses[stamp][:3, 3] for stamp in posed])
        self.assertLess(aligned_error_m(estimate, truth), 0.03)

    def test_1_the_beginning_is_in_the_log_and_the_end_in_the_state(self):
        self.assertEqual([line for line in self.seen.log if "tracking begins" in line or "lost its place" in line], ["tracking begins in a new map"])
        self.assertEqual(self.state_for_who_comes_now(), TrackingReport.WAITING)
        for stage in ("tracking", "motion"):
            self.assertTrue({"running", "waiting"} <= set(self.seen.health[stage]), self.seen.health[stage])

    def test_2_first_camera_is_level_and_its_body_at_the_initial_pose(self):
        first = min(self.seen.poses)
        self.assertLess(numpy.linalg.norm(self.seen.poses[first][:3, 3] - [0, 0, 1.2]), 0.1)
        forward = self.camera_pose(first)[:3, 2]
        self.assertGreater(forward[0], 0.98)

    def test_3_tf_has_the_pose_of_every_posed_frame(self):
        self.assertGreaterEqual(len(self.seen.transforms.keys() & self.seen.poses.keys()), len(self.seen.poses) - 1)
        with_odometry = rospy.has_param("~odom_base")
        for stamp, (child, pose) in self.seen.transforms.items():
            self.assertEqual(child, "odom" if with_odometry else self.body_frame)
            if stamp in self.seen.poses:
                numpy.testing.assert_allclose(pose @ self.odom_body, self.seen.poses[stamp], atol=1e-6)

    def test_3_odometry_is_the_pose_with_its_velocity(self):
        self.assertGreaterEqual(len(self.seen.odometry), len(self.seen.poses) - 1)
        for odometry in self.seen.odometry:
            self.assertEqual((odometry.header.frame_id, odometry.child_frame_id), ("map", self.body_frame))
            pose = self.seen.poses.get(odometry.header.stamp.to_nsec())
            if pose is not None:
                numpy.testing.assert_array_equal(matrix(odometry.pose.pose.position, odometry.pose.pose.orientation),
                                                 pose)
        speeds = [numpy.linalg.norm([v.x, v.y, v.z]) for v in (o.twist.twist.linear for o in self.seen.odometry)]
        stamps = sorted(self.recording.poses)
        path_m = sum(numpy.linalg.norm(self.recording.poses[b][:3, 3] - self.recording.poses[a][:3, 3])
                     for a, b in zip(stamps, stamps[1:]))
        mean_m_per_s = path_m / ((stamps[-1] - stamps[0]) * 1e-9)
        self.assertLess(abs(numpy.median(speeds) - mean_m_per_s), 0.5 * mean_m_per_s)
        for odometry in self.seen.odometry:
            sigma_m_per_s = numpy.sqrt(numpy.diag(numpy.reshape(odometry.twist.covariance, (6, 6)))[:3])
            self.assertTrue((sigma_m_per_s > 0.001).all(), "no velocity is known to a millimetre a second")

    def test_3_path_and_points_are_in_the_map(self):
        path, points = self.seen.newest["tracking/path"], self.seen.newest["tracking/points"]
        self.assertEqual((path.header.frame_id, points.header.frame_id), ("map", "map"))
        self.assertGreaterEqual(len(path.poses), 0.7 * len(self.recording.stamps))
        self.assertGreater(points.width * points.height, 200)

    def test_4_masks_have_the_stamps_of_images_and_cover_what_moves(self):
        self.assertGreaterEqual(len(self.seen.masks), 0.9 * len(self.recording.stamps))
        self.assertTrue(self.seen.masks.keys() <= set(self.recording.stamps))
        intersection = union = 0
        for stamp, (frame_id, mask) in self.seen.masks.items():
            self.assertEqual(frame_id.lstrip("/"), CAMERA_FRAME)
            truth = self.recording.masks[stamp]
            intersection += numpy.count_nonzero(mask & truth)
            union += numpy.count_nonzero(mask | truth)
        self.assertGreater(intersection / union, 0.3)

    def test_4_motion_reports_and_shows_the_flow(self):
        self.assertGreaterEqual(len(self.seen.motion), 0.9 * len(self.recording.stamps))
        rigid = [report for report in self.seen.motion if report.model == MotionReport.MODEL_RIGID_FLOW]
        self.assertGreaterEqual(len(rigid), 0.8 * len(self.seen.motion))
        self.assertTrue(all(report.inliers > 0 and 0 <= report.dynamic_share <= 1 for report in rigid))
        flow = self.seen.newest["motion/flow_image"]
        self.assertEqual(flow.encoding, "bgr8")
        self.assertIn(flow.header.stamp.to_nsec(), self.recording.stamps)

    def test_5_tracking_used_the_masks(self):
        with_mask = sum(1 for state in self.seen.states if state.has_mask)
        self.assertGreaterEqual(with_mask, 0.8 * len(self.seen.states))

    def test_6_cloud_holds_the_room(self):
        points = self.cloud()
        self.assertGreater(len(points), 2000)
        fields = {field.name for field in self.seen.newest["mapping/semantic_cloud"].fields}
        self.assertEqual(fields, {"x", "y", "z", "rgb", "label"})

    def test_7_no_point_is_where_people_walked(self):
        """A person left in the map would stand in space that the camera sees free before or after."""
        points = self.cloud()
        stamps = sorted(self.seen.poses.keys() & self.recording.depth_m.keys())
        violations = numpy.zeros(len(points), bool)
        for stamp in stamps[::5]:
            violations |= self.seen_through(points, self.camera_pose(stamp), self.recording.depth_m[stamp])
        self.assertLess(violations.mean(), 0.02)

    def seen_through(self, points, pose, depth_m):
        """Points that lie at least 0.2 m before everything the camera measured round their pixel."""
        camera = (points - pose[:3, 3]) @ pose[:3, :3]
        with numpy.errstate(divide="ignore", invalid="ignore"):
            pixel = camera @ self.recording.K.T
            u, v = numpy.rint(pixel[:, 0] / camera[:, 2]), numpy.rint(pixel[:, 1] / camera[:, 2])
        height, width = depth_m.shape
        inside = (camera[:, 2] > 0.3) & (u >= 0) & (v >= 0) & (u < width) & (v < height)
        # Holes count as near: nothing is known there. Neighbours count, so that pose errors at edges do not.
        near = cv2.erode(depth_m, numpy.ones((7, 7)))
        out = numpy.zeros(len(points), bool)
        out[inside] = near[v[inside].astype(int), u[inside].astype(int)] > camera[inside, 2] + 0.2
        return out

    def cloud(self):
        message = self.seen.newest["mapping/semantic_cloud"]
        self.assertEqual(message.header.frame_id, "map")
        points = sensor_msgs.point_cloud2.read_points(message, ("x", "y", "z"))
        return numpy.array(list(points), numpy.float64).reshape(-1, 3)

    def test_8_octomap_and_grid_are_published(self):
        binary, full = self.seen.newest["mapping/octomap_binary"], self.seen.newest["mapping/octomap_full"]
        self.assertTrue(binary.binary)
        self.assertEqual((binary.id, full.id), ("OcTree", "ColorOcTree"))
        self.assertGreater(len(binary.data), 100)
        self.assertGreater(len(full.data), len(binary.data))
        grid = self.seen.newest["mapping/projected_map"]
        cells = numpy.array(grid.data)
        self.assertEqual(len(cells), grid.info.width * grid.info.height)
        self.assertGreater(numpy.count_nonzero(cells == 100), 10)
        self.assertEqual(self.seen.newest["mapping/object_markers"].markers[0].action, Marker.DELETEALL)

    def test_8_people_are_told_of_where_they_are(self):
        distances, frames = [], 0
        fx, fy, cx, cy = (self.recording.K[index] for index in ((0, 0), (1, 1), (0, 2), (1, 2)))
        for message in self.seen.people:
            stamp = message.header.stamp.to_nsec()
            if stamp not in self.seen.poses or stamp not in self.recording.masks:
                continue
            self.assertEqual(message.header.frame_id, "map")
            depth = self.recording.depth_m[stamp]
            rows, columns = numpy.nonzero(self.recording.masks[stamp] & (depth > 0) & (depth < 4))
            if len(rows) < 0.05 * depth.size:
                continue
            frames += 1
            z = depth[rows, columns]
            points = numpy.stack(((columns - cx) / fx * z, (rows - cy) / fy * z, z, numpy.ones_like(z)))
            seen = (self.camera_pose(stamp) @ points)[:2].T
            for mover in message.movers:
                at = numpy.array((mover.pose.pose.position.x, mover.pose.pose.position.y))
                distances.append(numpy.linalg.norm(seen - at, axis=1).min())
        self.assertGreater(frames, 20)
        self.assertGreater(len(distances), 0.6 * frames, "movers while people are well in view")
        self.assertLess(numpy.percentile(distances, 90), 0.3)

    def test_9_services(self):
        """Last: it changes what the others look at."""
        self.check_saving()
        self.check_disorder()
        self.check_pause()
        self.check_reset()
        self.check_loading()
        self.check_octomap_server()
        self.check_clearing()

    def check_saving(self):
        for name in ("map.slam", "map.dense"):  # of an earlier test
            if os.path.exists(os.path.join(rospkg.get_ros_home(), name)):
                os.remove(os.path.join(rospkg.get_ros_home(), name))
        for name in ("/slam_tracking/save_trajectory", "/slam_tracking/save_map", "/slam_mapping/save"):
            answer = rospy.ServiceProxy(name, Trigger)()
            self.assertTrue(answer.success, answer.message)
        folder = rospkg.get_ros_home()  # where roslaunch runs the nodes
        poses = numpy.loadtxt(os.path.join(folder, "trajectory.txt"))
        self.assertEqual(poses.shape[1], 8)
        self.assertGreaterEqual(len(poses), 0.9 * len(self.recording.stamps))
        for name in ("cloud.pcd", "map.ot", "map.slam"):
            self.assertGreater(os.path.getsize(os.path.join(folder, name)), 1000)

    def check_disorder(self):
        """A frame that is older than the one before is passed over, and the map stays."""
        passed_over = []

        def on_diagnostics(message):
            for status in message.status:
                passed_over.extend(int(value.value) for value in status.values
                                   if value.key == "frames out of order by their stamps")

        diagnostics = rospy.Subscriber("/diagnostics", DiagnosticArray, on_diagnostics)
        map_id = self.seen.newest["tracking/keyframe_poses"].map_id
        kinds = {IMAGE_TOPIC: Image, DEPTH_TOPIC: Image, "/camera/rgb/camera_info": CameraInfo}
        publishers = {topic: rospy.Publisher(topic, kind, queue_size=1) for topic, kind in kinds.items()}
        wait_until(lambda: all(p.get_num_connections() >= self.processes for p in publishers.values()), 20, "a connection")
        first = self.recording.first(kinds)
        for topic, publisher in publishers.items():
            publisher.publish(first[topic])
        wait_until(lambda: passed_over and passed_over[-1] == 1, 20, "a report of the old frame")
        diagnostics.unregister()
        self.assertEqual(self.seen.newest["tracking/keyframe_poses"].map_id, map_id)

    def check_pause(self):
        """Also shows that a clock that goes back is taken for a new recording."""
        answer = rospy.ServiceProxy("/slam_tracking/pause", SetBool)(True)
        self.assertTrue(answer.success)
        self.assertIn("paused", answer.message)
        wait_until(lambda: self.seen.idle[-1].state == TrackingReport.PAUSED, 5, "a report of the pause")
        self.assertGreater(self.seen.idle[-1].keyframes, 0)
        self.assertEqual(self.state_for_who_comes_now(), TrackingReport.PAUSED)
        before = len(self.seen.states)
        play(self.recording.path, "--duration", "1")
        self.assertEqual(len(self.seen.states), before)
        self.assertTrue(any("paused" == message for message in self.seen.health["tracking"]), self.seen.health["tracking"])
        self.assertIn("running", rospy.ServiceProxy("/slam_tracking/pause", SetBool)(False).message)
        wait_until(lambda: self.seen.idle[-1].state == TrackingReport.WAITING, 5, "a report of waiting")
        map_id = self.seen.newest["tracking/keyframe_poses"].map_id
        self.seen.states.clear()
        play(self.recording.path, "--duration", "2")
        wait_until(lambda: self.seen.newest["tracking/keyframe_poses"].map_id != map_id, 20, "a new map")
        self.seen.wait_for_tracking()

    def check_reset(self):
        map_id = self.seen.newest["tracking/keyframe_poses"].map_id
        self.assertTrue(rospy.ServiceProxy("/slam_tracking/reset", Trigger)().success)
        wait_until(lambda: self.seen.idle[-1].keyframes == 0, 5, "a report of the empty map")
        answer = rospy.ServiceProxy("/slam_tracking/localization_only", SetBool)(True)
        self.assertFalse(answer.success)
        self.assertIn("no map to localise in", answer.message)
        self.check_that_nothing_is_saved("/slam_tracking/save_map", "map.slam")
        self.seen.states.clear()
        self.assertTrue(rospy.ServiceProxy("/slam_mapping/clear", Trigger)().success)
        play(self.recording.path, "--start", "2", "--duration", "0.4")
        wait_until(lambda: self.seen.newest["tracking/keyframe_poses"].map_id != map_id, 20, "a new map after reset")
        self.seen.wait_for_tracking()
        # The map of a tenth of the recording does not take the place of that of all of it.
        self.check_that_nothing_is_saved("/slam_tracking/save_map", "map.slam", "is another map")
        before = self.file_state("map.dense")
        save = rospy.ServiceProxy("/slam_mapping/save", Trigger)
        wait_until(lambda: "but not map.dense" in save().message, 20, "the first keyframe in the dense map, which is not saved")
        self.assertEqual(self.file_state("map.dense"), before)

    def check_loading(self):
        """The camera finds itself in the saved map, which stays as it is."""
        answer = rospy.ServiceProxy("/slam_tracking/localization_only", SetBool)(True)
        self.assertTrue(answer.success)
        self.assertIn("stays as it is", answer.message)
        answer = rospy.ServiceProxy("/slam_tracking/reset", Trigger)()
        self.assertFalse(answer.success)
        self.assertIn("localization_only is on", answer.message)
        answer = rospy.ServiceProxy("/slam_tracking/load_map", Trigger)()
        self.assertTrue(answer.success, answer.message)
        self.seen.states.clear()
        self.seen.keyframes.clear()
        play(self.recording.path, "--start", "3")
        self.seen.wait_for_tracking()
        self.hang_elsewhere(next(iter(self.seen.transforms.values()))[0])
        self.seen.states.clear()
        play(self.recording.path, "--duration", "2")  # the clock goes back: the map that was loaded stays all the same
        self.seen.wait_for_tracking()
        self.assertTrue(any("found its place in the map of" in line and "by relocalisation" in line for line in self.seen.log), self.seen.log)
        self.assertEqual(self.seen.transforms, {}, "tf that would take the frame from its parent")
        self.assertEqual(self.seen.keyframes, [])
        self.assertEqual(len({state.keyframes for state in self.seen.states}), 1)
        self.assertGreater(len(self.seen.newest["tracking/keyframe_poses"].keyframes), 1)

    def hang_elsewhere(self, frame):
        """Another node gives the frame a parent, as a robot's URDF or a driver does."""
        edge = TransformStamped(child_frame_id=frame)
        edge.header.frame_id = "elsewhere"
        edge.transform.rotation.w = 1.0
        self.robot = rospy.Publisher("/tf_static", TFMessage, queue_size=1, latch=True)
        self.robot.publish(TFMessage([edge]))
        wait_until(lambda: self.robot.get_num_connections() >= 1, 20, "somebody who listens to tf")
        time.sleep(1.0)
        self.seen.transforms.clear()

    @staticmethod
    def state_for_who_comes_now():
        return int(subprocess.check_output(["rostopic", "echo", "-n1", "tracking/state/state"], text=True, timeout=30).split()[0])

    @staticmethod
    def file_state(name):
        """Another one when the file is written."""
        status = os.stat(os.path.join(rospkg.get_ros_home(), name))
        return status.st_ino, status.st_size, status.st_mtime_ns

    def check_that_nothing_is_saved(self, service, name, why="not touched"):
        """An empty or smaller map does not take the place of the file of a good one."""
        before = self.file_state(name)
        answer = rospy.ServiceProxy(service, Trigger)()
        self.assertFalse(answer.success, answer.message)
        self.assertIn(why, answer.message)
        self.assertEqual(self.file_state(name), before)

    def heights(self):
        """Of the map's points, metres."""
        return [z for (z,) in sensor_msgs.point_cloud2.read_points(self.seen.newest["mapping/semantic_cloud"], ("z",))]

    def check_octomap_server(self):
        """The services of octomap_server and map_server answer with what the topics show."""
        seen = self.seen.newest
        binary = rospy.ServiceProxy("/slam_mapping/octomap_binary", GetOctomap)().map
        self.assertEqual((binary.id, binary.binary, binary.resolution), ("OcTree", True, 0.03))
        self.assertEqual(rospy.ServiceProxy("/slam_mapping/octomap_full", GetOctomap)().map.id, "ColorOcTree")
        grid = rospy.ServiceProxy("/slam_mapping/static_map", GetMap)().map
        self.assertEqual((round(grid.info.resolution, 6), grid.header.frame_id), (0.06, "map"))
        self.assertGreater(sum(cell == 100 for cell in grid.data), 20)
        centres = rospy.wait_for_message("mapping/octomap_point_cloud_centers", PointCloud2, 60)
        cubes = {state: rospy.wait_for_message(f"mapping/{state}_cells_vis_array", MarkerArray, 60).markers
                 for state in ("occupied", "free")}
        self.assertEqual(sum(len(marker.points) for marker in cubes["occupied"]), centres.width)
        self.assertGreater(sum(len(marker.points) for marker in cubes["free"]), 1000)
        clear = rospy.ServiceProxy("/slam_mapping/clear_bbx", BoundingBoxQuery)
        with self.assertRaises(rospy.ServiceException):
            clear(Point(1, 0, 0), Point(-1, 0, 0))
        middle = numpy.median(self.heights())
        clear(Point(-50, -50, middle), Point(50, 50, 50))
        wait_until(lambda: seen["mapping/semantic_cloud"].width > 0 and max(self.heights()) < middle + 0.02, 20, "a cleared box")
        rospy.ServiceProxy("/slam_mapping/reset", Empty)()
        with self.assertRaises(rospy.ServiceException):
            rospy.ServiceProxy("/slam_mapping/static_map", GetMap)()

    def check_clearing(self):
        self.assertTrue(rospy.ServiceProxy("/slam_mapping/clear", Trigger)().success)
        self.check_that_nothing_is_saved("/slam_mapping/save", "cloud.pcd")
        # Who comes now gets the map as it is, not the last one that somebody watched.
        points = subprocess.check_output(["rostopic", "echo", "-n1", "mapping/semantic_cloud/width"], text=True, timeout=30)
        self.assertEqual(points.split()[0], "0")
        wait_until(lambda: self.seen.newest["mapping/semantic_cloud"].width == 0, 20, "an empty cloud")


if __name__ == "__main__":
    import rostest
    rostest.rosrun("semantic_vslam", "slam_test", SlamTest)

# SPDX-FileCopyrightText: 2026 The semantic_vslam authors
# SPDX-License-Identifier: BSD-3-Clause
"""The launch files as roslaunch reads them, without a master."""
import os
import signal
import subprocess
import sys
import tempfile
import time
import unittest
import xml.etree.ElementTree

sys.path.append(os.path.join(os.path.dirname(os.path.dirname(os.path.abspath(__file__))), "ros"))
from programs import program

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
STAGES = ("motion", "tracking", "segmentation", "mapping")


def arguments(launch_file):
    """@return {name: (default, doc)} of the arguments that a user can give"""
    root = xml.etree.ElementTree.parse(os.path.join(ROOT, "launch", launch_file)).getroot()
    return {arg.get("name"): (arg.get("default"), arg.get("doc")) for arg in root.iter("arg")
            if arg.get("value") is None and arg in list(root)}


def roslaunch(*arguments, **environment):
    return subprocess.run(["roslaunch", *arguments], capture_output=True, text=True, timeout=60, env={**os.environ, **environment})


def nodes(*arguments):
    """@return names of the nodes that would start"""
    result = roslaunch("--nodes", *arguments)
    if result.returncode != 0:
        raise AssertionError(result.stderr)
    return set(result.stdout.split())


class CameraFiles(unittest.TestCase):
    # What a file says itself, and what it may want otherwise than slam.launch.
    FIXED = {"realsense.launch": {"rgb", "depth", "info", "rectified"}, "kinect.launch": {"rgb", "info", "rectified"},
             "tum_bag.launch": {"rgb", "depth", "info", "rectified", "camera_file"}}
    OTHER_DEFAULT = {"base_frame", "rviz", "depth"}

    def test_take_every_argument_of_slam_launch(self):
        for name, fixed in self.FIXED.items():
            have = arguments(name)
            for argument, (default, doc) in arguments("slam.launch").items():
                if argument in fixed:
                    continue
                with self.subTest(file=name, argument=argument):
                    self.assertIn(argument, have)
                    self.assertTrue(doc, "says what it is")
                    if argument not in self.OTHER_DEFAULT:
                        self.assertEqual(have[argument], (default, doc))

    def test_can_be_included_twice_with_arguments(self):
        with tempfile.NamedTemporaryFile("w", suffix=".launch") as file:
            file.write("""<launch>
              <group ns="front"><include file="$(find semantic_vslam)/launch/realsense.launch">
                <arg name="camera" value="/front_camera"/><arg name="odom_frame" value="odom"/><arg name="rviz" value="false"/>
              </include></group>
              <group ns="back"><include file="$(find semantic_vslam)/launch/kinect.launch">
                <arg name="camera" value="/back_camera"/><arg name="publish_tf" value="false"/><arg name="rviz" value="false"/>
              </include></group>
            </launch>""")
            file.flush()
            self.assertEqual(nodes(file.name), {f"/{ns}/slam_{stage}" for ns in ("front", "back") for stage in STAGES + ("manager",)})
            parameters = roslaunch("--dump-params", file.name).stdout
        self.assertIn("/front/slam_tracking/frames/odom_frame: odom", parameters)
        self.assertIn("/back/slam_tracking/frames/publish_tf: false", parameters)


class SlamLaunch(unittest.TestCase):
    def test_starts_the_stages_asked_for(self):
        self.assertEqual(nodes("semantic_vslam", "slam.launch", "stages:=tracking motion", "nodelets:=false"),
                         {"/slam_tracking", "/slam_motion"})

    def test_uses_the_managers_of_drivers(self):
        self.assertEqual(nodes("semantic_vslam", "slam.launch", "manager:=/camera/realsense2_camera_manager"),
                         {"/slam_" + stage for stage in STAGES})
        result = roslaunch("--args", "/slam_tracking", "semantic_vslam", "slam.launch", "manager:=/camera/realsense2_camera_manager")
        self.assertIn("semantic_vslam/Tracking /camera/realsense2_camera_manager", result.stdout)

    def test_needs_no_home(self):
        environment = {key: value for key, value in os.environ.items() if key != "HOME"}
        result = subprocess.run(["roslaunch", "--nodes", "semantic_vslam", "realsense.launch"], capture_output=True, text=True,
                                timeout=60, env=environment)
        self.assertEqual(result.returncode, 0, result.stderr)

    def test_arguments_that_nobody_gave_leave_the_configuration_file_alone(self):
        def parameters(*arguments):
            lines = roslaunch("--dump-params", "semantic_vslam", "slam.launch", *arguments).stdout.splitlines()
            return {line.split(": ")[0]: line.split(": ")[1] for line in lines if line.startswith("/slam_")}

        self.assertEqual({name.rsplit("/")[-1] for name in parameters()}, {"config_file", "num_worker_threads"})
        given = parameters("sync:=exact", "map_frame:=world", "output:=/tmp/my maps", "publish_tf:=false", "queue_size:=7")
        for stage in STAGES:
            self.assertEqual((given[f"/slam_{stage}/input/sync"], given[f"/slam_{stage}/input/queue_size"]), ("exact", "7"))
        for stage in ("tracking", "mapping"):
            self.assertEqual(given[f"/slam_{stage}/frames/map_frame"], "world")
            self.assertEqual(given[f"/slam_{stage}/output_directory"], "/tmp/my maps")
        self.assertEqual(given["/slam_tracking/frames/publish_tf"], "false")

    def test_no_node_ends_the_others(self):
        for name in os.listdir(os.path.join(ROOT, "launch")):
            root = xml.etree.ElementTree.parse(os.path.join(ROOT, "launch", name)).getroot()
            for node in root.iter("node"):
                self.assertIsNone(node.get("required"), f"{name}: {node.get('name')}")


class NodePrograms(unittest.TestCase):
    """Each tells of its keys, without a ROS master."""

    def ask(self, stage, *arguments):
        return subprocess.run([program(stage + "_node"), *arguments], capture_output=True, text=True, timeout=30,
                              env={**os.environ, "ROS_MASTER_URI": "http://localhost:1"})

    def test_list_their_keys(self):
        own = {"motion": "motion.model", "tracking": "frames.tf_wait_s", "segmentation": "segmentation.threads",
               "mapping": "labels_wait_s"}
        for stage in STAGES:
            result = self.ask(stage, "--list-config")
            self.assertEqual((result.returncode, result.stderr), (0, ""))
            keys = {line.split()[0]: line for line in result.stdout.splitlines()}
            self.assertIn(own[stage], keys)
            self.assertRegex(keys["input.max_interval_s"], r" 0\.02 +\[0, 0\.1\]  s between colour and depth")
            self.assertEqual({name for name in own.values() if name in keys}, {own[stage]})

    def test_help(self):
        for stage in STAGES:
            result = self.ask(stage, "--help")
            self.assertEqual(result.returncode, 0)
            self.assertIn(f"usage: {stage}_node", result.stdout)
            self.assertIn("--list-config", result.stdout)

    def test_refuse_options_that_they_do_not_have(self):
        result = self.ask("motion", "--list-confg")
        self.assertEqual((result.returncode, result.stdout), (2, ""))
        self.assertIn("--list-confg", result.stderr)


class Respawn(unittest.TestCase):
    def run_script(self, command):
        return subprocess.run([os.path.join(ROOT, "scripts", "respawn"), "bash", "-c", command], capture_output=True, text=True,
                              timeout=30)

    def test_starts_again_what_a_signal_killed_and_says_so_to_it(self):
        with tempfile.TemporaryDirectory() as folder:
            result = self.run_script(f"echo \"${{SEMANTIC_VSLAM_RESTARTED:-first}}\" >>{folder}/starts; "
                                     f"[ $(wc -l <{folder}/starts) = 3 ] || kill -9 $$; exit 3")
            with open(os.path.join(folder, "starts")) as file:
                self.assertEqual(file.read().split(), ["first", "true", "true"])
        self.assertEqual(result.returncode, 3)
        self.assertEqual(result.stderr.count("killed by signal 9"), 2)

    def test_does_not_start_again_what_ends_by_itself(self):
        for status in (0, 1, 2):
            result = self.run_script(f"echo once; exit {status}")
            self.assertEqual((result.returncode, result.stdout, result.stderr), (status, "once\n", ""))

    def test_ends_with_its_child_when_told_to(self):
        process = subprocess.Popen([os.path.join(ROOT, "scripts", "respawn"), "bash", "-c", "trap 'exit 0' INT; while true; do sleep 0.1; done"],
                                   start_new_session=True, stderr=subprocess.PIPE, text=True)
        time.sleep(0.5)
        os.killpg(process.pid, signal.SIGINT)
        _, errors = process.communicate(timeout=10)
        self.assertEqual((process.returncode, errors), (0, ""))


if __name__ == "__main__":
    unittest.main()

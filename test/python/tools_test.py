#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The semantic_vslam authors
# SPDX-License-Identifier: BSD-3-Clause
"""Runs the tools as a user does, on a small rendered sequence: a box before a wall, the camera moving sideways."""
import filecmp
import json
import math
import os
import pty
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest

import cv2
import numpy as np

sys.path.append(os.path.join(os.path.dirname(__file__), "..", "ros"))
from programs import program, skip_without_programs

FRAMES, WIDTH, HEIGHT, FOCAL_PX = 40, 320, 240, 260.0
WALL_M, BOX_M = 2.5, 1.6


def run(name, *arguments):
    return subprocess.run([program(name)] + [str(a) for a in arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                          universal_newlines=True, timeout=300)


def texture(seed):
    """Noise of several sizes, so that features are found at every level of the pyramid."""
    rng = np.random.RandomState(seed)
    image = np.zeros((1024, 1024, 3), np.float32)
    for cells in (16, 48, 128, 384):
        image += cv2.resize(rng.rand(cells, cells, 3).astype(np.float32), (1024, 1024), interpolation=cv2.INTER_NEAREST)
    return np.uint8(image / 4 * 255)


def render(position, wall, box):
    """Colour and depth (1/5000 m) of a camera at (x, y, 0) that looks along z."""
    u, v = np.meshgrid(np.arange(WIDTH), np.arange(HEIGHT))
    ray_x, ray_y = (u - WIDTH / 2) / FOCAL_PX, (v - HEIGHT / 2) / FOCAL_PX
    layers = []
    for depth_m, picture in ((WALL_M, wall), (BOX_M, box)):
        x_m, y_m = position[0] + ray_x * depth_m, position[1] + ray_y * depth_m
        map_x, map_y = ((a + 2.5) * 200 for a in (x_m, y_m))  # 200 texture pixels a metre
        layers.append((cv2.remap(picture, map_x.astype(np.float32), map_y.astype(np.float32), cv2.INTER_LINEAR), x_m, y_m))
    on_box = (np.abs(layers[1][1]) < 0.4) & (np.abs(layers[1][2]) < 0.3)
    colour = np.where(on_box[..., None], layers[1][0], layers[0][0])
    return colour, np.where(on_box, BOX_M * 5000, WALL_M * 5000).astype(np.uint16)


def write_sequence(folder):
    for name in ("rgb", "depth"):
        os.makedirs(os.path.join(folder, name))
    wall, box = texture(1), texture(2)
    with open(f"{folder}/rgb.txt", "w") as rgb, open(f"{folder}/depth.txt", "w") as depth, \
            open(f"{folder}/groundtruth.txt", "w") as truth:
        for i in range(FRAMES):
            stamp = f"{1000 + i / 30:.6f}"
            position = (0.5 * math.sin(0.06 * i), 0.15 * math.sin(0.1 * i))
            colour, depth_image = render(position, wall, box)
            cv2.imwrite(f"{folder}/rgb/{stamp}.png", colour)
            cv2.imwrite(f"{folder}/depth/{stamp}.png", depth_image)
            rgb.write(f"{stamp} rgb/{stamp}.png\n")
            depth.write(f"{stamp} depth/{stamp}.png\n")
            truth.write(f"{stamp} {position[0]:.6f} {position[1]:.6f} 0 0 0 0 1\n")
    with open(f"{folder}/camera.yaml", "w") as camera:
        camera.write(f"width: {WIDTH}\nheight: {HEIGHT}\nfx: {FOCAL_PX}\nfy: {FOCAL_PX}\ncx: {WIDTH / 2}\ncy: {HEIGHT / 2}\n")


class ToolsTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        skip_without_programs()
        cls.folder = tempfile.mkdtemp(prefix="semantic_vslam_tools_")
        cls.sequence = os.path.join(cls.folder, "sequence")
        write_sequence(cls.sequence)
        cls.camera = os.path.join(cls.sequence, "camera.yaml")

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.folder)

    def out(self, name):
        return os.path.join(self.folder, name)

    def offline(self, recording, name, *arguments):
        """Without a network, which knows nothing of this recording."""
        done = run("run_offline", recording, "--camera", self.camera, "--out", self.out(name), "--set", "segmentation.model=", *arguments)
        self.assertEqual(done.returncode, 0, done.stderr)
        with open(os.path.join(self.out(name), "summary.json")) as file:
            return json.load(file)

    def test_offline_follows_the_camera_and_writes_everything(self):
        summary = self.offline(self.sequence, "run", "--masks")
        self.assertEqual(summary["frames"], FRAMES)
        self.assertGreaterEqual(summary["posed_share"], 0.95)
        self.assertLess(summary["ate_rmse_m"], 0.01)
        self.assertGreater(summary["cloud_points"], 1000)
        self.assertIn("tracking", summary["stages"])
        for name in ("trajectory.txt", "keyframes.txt", "cloud.pcd", "map.ot", "mesh.ply", "timing.csv", "overview.png"):
            self.assertGreater(os.path.getsize(os.path.join(self.out("run"), name)), 0, name)
        self.assertEqual(len(os.listdir(os.path.join(self.out("run"), "masks"))), FRAMES)

        evaluated = run("evaluate_trajectory", f"{self.sequence}/groundtruth.txt", f"{self.out('run')}/trajectory.txt", "--json")
        self.assertAlmostEqual(json.loads(evaluated.stdout)["ate_m"]["rmse"], summary["ate_rmse_m"], places=6)

    def test_folder_and_bag_give_the_same_bytes(self):
        bag = self.out("sequence.bag")
        done = run("tum_to_bag", self.sequence, bag, "--camera", self.camera, "--lz4")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.offline(self.sequence, "from_folder", "--deterministic")
        summary = self.offline(bag, "from_bag", "--deterministic")
        self.assertIsNotNone(summary["ate_rmse_m"], "ground truth comes from the bag's tf")
        for name in ("trajectory.txt", "keyframes.txt", "cloud.pcd", "map.ot"):
            self.assertTrue(filecmp.cmp(f"{self.out('from_folder')}/{name}", f"{self.out('from_bag')}/{name}", shallow=False), name)

    def test_the_packages_network_runs_unless_told_otherwise(self):
        part = ("--frames", 5, "--set", "dense.enabled=false")
        done = run("run_offline", self.sequence, "--camera", self.camera, "--out", self.out("network"), *part)
        self.assertEqual(done.returncode, 0, done.stderr)
        with open(os.path.join(self.out("network"), "summary.json")) as file:
            self.assertIn("segmentation", json.load(file)["stages"])
        self.assertNotIn("segmentation", self.offline(self.sequence, "no_network", *part)["stages"])

    def test_start_and_frames_choose_a_part(self):
        summary = self.offline(self.sequence, "part", "--start", 10, "--frames", 12, "--set", "dense.enabled=false")
        self.assertEqual(summary["frames"], 12)
        with open(os.path.join(self.out("part"), "timing.csv")) as file:
            frames = [int(line.split(",")[1]) for line in file if line.startswith("tracking,")]
        self.assertEqual(frames, list(range(10, 22)))
        self.assertFalse(os.path.exists(os.path.join(self.out("part"), "cloud.pcd")))

    def cut(self, number):
        """A run that gets a signal in the middle. @return its status"""
        command = [program("run_offline"), self.sequence, "--camera", self.camera, "--out", self.out("cut"), "--realtime",
                   "--set", "segmentation.model="]
        process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, universal_newlines=True)
        process.stderr.readline()  # the first message comes when the system is set up; at their own pace the frames
        time.sleep(0.3)            # then take over a second
        process.send_signal(number)
        process.communicate(timeout=120)
        return process.returncode

    def summary(self, name):
        """The report, when it and the files that it names are of one moment."""
        folder = self.out(name)
        with open(os.path.join(folder, "summary.json")) as file:
            summary = json.load(file)
        here = {name for name in os.listdir(folder) if name != "summary.json"}
        self.assertEqual(set(summary["files"]), {name for name in here if os.path.isfile(os.path.join(folder, name)) or
                                                 os.listdir(os.path.join(folder, name))})
        for name, size in summary["files"].items():
            path = os.path.join(folder, name)
            parts = [os.path.join(path, part) for part in os.listdir(path)] if os.path.isdir(path) else [path]
            self.assertEqual(sum(map(os.path.getsize, parts)), size, name)
        return summary

    def test_a_signal_writes_what_there_is(self):
        for number, said in ((signal.SIGINT, "SIGINT"), (signal.SIGTERM, "SIGTERM"), (signal.SIGHUP, "SIGHUP")):
            with self.subTest(said):
                self.assertEqual(self.cut(number), 0)
                summary = self.summary("cut")
                self.assertIn(said, summary["ended"])
                self.assertLess(summary["frames"], FRAMES)
                self.assertIn("trajectory.txt", summary["files"])

    def test_a_run_that_was_killed_passes_for_none(self):
        self.offline(self.sequence, "cut")
        left_over = os.path.join(self.out("cut"), ".writing-999999999-0-cloud.pcd")
        open(left_over, "w").close()
        self.assertEqual(self.cut(signal.SIGKILL), -signal.SIGKILL)
        self.assertFalse(os.path.exists(os.path.join(self.out("cut"), "summary.json")), "the earlier run's")
        self.assertFalse(os.path.exists(os.path.join(self.out("cut"), "cloud.pcd")), "the earlier run's")
        self.assertFalse(os.path.exists(left_over))

    def test_images_that_end_unreadable_lose_nothing_of_those_before(self):
        folder = self.out("ends")
        shutil.copytree(self.sequence, folder)
        for name in sorted(os.listdir(os.path.join(folder, "rgb")))[20:]:
            with open(os.path.join(folder, "rgb", name), "wb") as image:
                image.write(b"\x89PNG")
        done = run("run_offline", folder, "--camera", self.camera, "--out", self.out("ended"), "--set", "segmentation.model=")
        self.assert_one_error(done, "in a row cannot be read")
        summary = self.summary("ended")
        self.assertEqual(summary["frames"], 20)
        self.assertIn("in a row cannot be read", summary["ended"])
        self.assertGreaterEqual(summary["posed"], 19)

    def test_a_folder_is_of_one_run(self):
        self.offline(self.sequence, "twice", "--masks")
        kept = os.path.join(self.out("twice"), "masks", "of the user.png")
        open(kept, "w").close()
        self.offline(self.sequence, "twice", "--frames", 10, "--masks", "--set", "dense.enabled=false")
        summary = self.summary("twice")
        self.assertEqual(summary["ended"], "complete")
        self.assertNotIn("cloud.pcd", summary["files"])
        self.assertEqual(len(os.listdir(os.path.join(self.out("twice"), "masks"))), 11)
        self.assertTrue(os.path.exists(kept), "only what a run writes is removed")

    def assert_one_error(self, done, named):
        self.assertIn(done.returncode, (1, 2))
        errors = [line for line in done.stderr.splitlines() if not line.startswith(("info:", "warning:"))]
        self.assertEqual(len(errors), 1, done.stderr)
        self.assertIn(named, errors[0])

    def test_loops_are_measured_in_a_folder_wherever_its_name_stands(self):
        done = run("measure_loops", "--verbose", self.sequence, "--camera", self.camera)
        self.assertEqual(done.returncode, 0, done.stderr)
        result = json.loads(done.stdout)
        self.assertEqual((result["recording"], result["frames"]), (self.sequence, FRAMES))
        self.assertLess(result["ate_m"], 0.01)

    def broken_copy(self):
        """The sequence's first frames, each image cut off in the middle."""
        folder = self.out("broken")
        if not os.path.isdir(folder):
            os.makedirs(os.path.join(folder, "rgb"))
            os.makedirs(os.path.join(folder, "depth"))
            for name in ("rgb", "depth"):
                with open(f"{self.sequence}/{name}.txt") as whole, open(f"{folder}/{name}.txt", "w") as part:
                    for line in list(whole)[:5]:
                        part.write(line)
                        with open(os.path.join(folder, line.split()[1]), "wb") as image:
                            image.write(b"\x89PNG")
            shutil.copy(f"{self.sequence}/groundtruth.txt", folder)
        return folder

    def test_a_recording_of_broken_images_alone_is_one_error(self):
        folder = self.broken_copy()
        for name, *options in (("run_offline", "--out", self.out("none")), ("measure_motion",), ("measure_growth",),
                               ("measure_loops",), ("measure_segmentation", "--dilate", 3), ("measure_places",)):
            with self.subTest(name):
                self.assert_one_error(run(name, folder, "--camera", self.camera, *options), "none of its frames can be read")

    def test_scores_every_label_and_their_mean_with_and_without_the_background(self):
        folder = self.out("labelled")
        shutil.copytree(self.sequence, folder)
        os.makedirs(os.path.join(folder, "labels"), exist_ok=True)
        for name in os.listdir(os.path.join(folder, "rgb")):
            image = cv2.imread(os.path.join(folder, "rgb", name))
            labels = np.zeros(image.shape[:2], np.uint8)
            labels[10:50, 10:50], labels[30:40, 70:110] = 1, 2
            cv2.imwrite(os.path.join(folder, "labels", os.path.splitext(name)[0] + ".png"), labels)
        done = run("measure_segmentation", folder, "--camera", self.camera, "--dilate", 3)
        self.assertEqual(done.returncode, 0, done.stderr)
        rows = re.findall(r"^(\w[\w ]*?) +IoU ([\d.]+), refined [\d.]+$", done.stdout, re.M)
        found = {name: float(value) for name, value in rows}
        self.assertEqual(list(found), ["background", "person", "label 2", "mean"])
        self.assertTrue(0.9 < found["background"] < 1.0 and 0.5 < found["label 2"] < found["person"] < 0.9, found)
        self.assertAlmostEqual(found["mean"], (found["background"] + found["person"] + found["label 2"]) / 3, delta=0.001)
        labels_alone = float(re.search(r"^mean +IoU ([\d.]+), refined [\d.]+, without background$", done.stdout, re.M)[1])
        self.assertAlmostEqual(labels_alone, (found["person"] + found["label 2"]) / 2, delta=0.001)

    def test_outputs_that_cannot_be_written_fail_before_the_run(self):
        self.assert_one_error(run("run_offline", self.sequence, "--camera", self.camera, "--out", "/proc"), "/proc/summary.json")
        for option in ("--map", "--trajectory"):
            for path in ("/nonexistent/file", self.folder):
                done = run("measure_loops", self.sequence, "--camera", self.camera, "--verbose", option, path)
                self.assert_one_error(done, path)
        done = run("measure_motion", self.sequence, "--camera", self.camera, "--pictures", "/proc", "--every", 1)
        self.assert_one_error(done, "/proc/000000.png")

    def test_output_that_cannot_be_written_is_no_success(self):
        truth = f"{self.sequence}/groundtruth.txt"
        with open("/dev/full", "w") as full:
            done = subprocess.run([program("evaluate_trajectory"), truth, truth, "--json"], stdout=full,
                                  stderr=subprocess.PIPE, universal_newlines=True, timeout=60)
        self.assert_one_error(done, "standard output")
        for option in ("--delta", "--max-gap"):
            self.assert_one_error(run("evaluate_trajectory", truth, truth, option, "1e300"), option)

    def test_no_frames_are_none_to_run(self):
        for name, *options in (("run_offline", "--out", self.out("none")), ("measure_motion",), ("measure_growth",),
                               ("measure_loops",)):
            with self.subTest(name):
                self.assert_one_error(run(name, self.sequence, "--camera", self.camera, "--frames", 0, *options), "--frames")

    def test_progress_is_one_line_on_a_terminal_and_none_of_a_short_run_in_a_file(self):
        command = [program("tum_to_bag"), self.sequence, self.out("progress.bag"), "--camera", self.camera]
        terminal, other_end = pty.openpty()
        subprocess.run(command, stdout=subprocess.DEVNULL, stderr=other_end, check=True, timeout=60)
        os.close(other_end)
        shown = os.read(terminal, 65536).decode()
        os.close(terminal)
        self.assertIn(f"\r{FRAMES}/{FRAMES} frames", shown)
        self.assertEqual(shown.count("\n"), 2, shown)  # that line, and what was written
        in_file = run("tum_to_bag", *command[1:]).stderr
        self.assertEqual(in_file.splitlines(), [f"{FRAMES} frames, 0 masks, 0 left out"])

    def test_nothing_is_rendered_unasked(self):
        for name in ("measure_loops", "measure_places"):
            self.assert_one_error(run(name), "--scenario")
            self.assert_one_error(run(name, self.sequence), "--camera")

    def test_mistakes_are_one_line_that_names_them(self):
        truncated = self.out("truncated.bag")
        run("tum_to_bag", self.sequence, truncated, "--frames", 5)
        with open(truncated, "r+b") as file:
            file.truncate(os.path.getsize(truncated) // 2)
        misspelt = self.out("misspelt.yaml")
        with open(misspelt, "w") as file:
            file.write("people.keep_s: 2\ninput.max_intervall_s: 0.03\n")  # the first is a node's
        cases = (
            ((truncated,), "truncated.bag"),
            (("/nonexistent",), "/nonexistent"),
            ((self.sequence, "--set", "tracking.nonsense=1"), "tracking.nonsense"),
            ((self.sequence, "--set", "motion.model=magic"), "motion.model"),
            ((self.sequence, "--set", "segmentation.model=/nonexistent.onnx"), "/nonexistent.onnx"),
            ((self.sequence, "--config", "/nonexistent.yaml"), "/nonexistent.yaml"),
            ((self.sequence, "--config", misspelt), "input.max_interval_s"),
            ((self.sequence, "--start", "999"), "999"),
            ((self.sequence, "--typo"), "--typo"),
        )
        for arguments, named in cases:
            with self.subTest(arguments):
                done = run("run_offline", *arguments, "--camera", self.camera, "--out", self.out("mistake"))
                self.assert_one_error(done, named)


if __name__ == "__main__":
    unittest.main()

#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The semantic_vslam authors
# SPDX-License-Identifier: BSD-3-Clause
"""Tables of ./run bench from what the tools print: a line that misses its bound ends in a star."""
import contextlib
import io
import json
import os
import sys
import tempfile
import unittest
from unittest import mock

sys.path.append(os.path.join(os.path.dirname(__file__), "..", "..", "scripts"))
import bench
import bench_dense
import bench_map
import bench_motion
import bench_variations


def printing(numbers):
    """Stands for bench.run: a tool that prints these numbers."""
    return lambda command: json.dumps(numbers)


def missed(text):
    return [line[:48].strip() for line in text.splitlines() if line.endswith("*")]


class BenchTest(unittest.TestCase):
    def recovery(self, **changed):
        saved = {"frames_needed": [1, 10], "ate_m": [0.010, 0.0119], "bytes_unchanged": True, "start_s": 0.5}
        numbers = {"cuts": {"count": 50, "back_within_10_frames": 48, "wrong_place": 0, "ate_m": []},
                   "covered_for_good_is_lost_and_keeps_map": True, "saved_map": {**saved, **changed}}
        return bench_map.recovery(printing(numbers), "", "DIR", "FILE")[1]

    def test_recovery_within_its_bounds_has_no_star(self):
        self.assertEqual(missed(self.recovery()), [])

    def test_a_start_that_finds_no_place_or_finds_it_late_has_one(self):
        for needed in ([1, -1], [1, 11]):
            self.assertEqual(missed(self.recovery(frames_needed=needed)), ["saved map: posed after, frames"])

    def test_a_map_s_figures_have_a_star_where_they_miss_what_is_asked(self):
        room = {"points_within_2cm": 0.96, "voxels_beyond_5cm": 0.012, "voxels_of_people": 0.0, "surface_found": 0.9,
                "labels_right": 0.99, "insertion_ms": 20.0, "grid": {"free": 700, "free_on_obstacle": 0},
                "objects": {"chair": {"things": 3, "listed_once": 2, "centroid_error_m": [0.02, 0.05]}}}
        self.assertEqual(missed(bench_dense.rooms_table([room])),
                         ["voxels beyond 5 cm of anything, %", "chair: listed once; centroid off, m (mid, worst)"])
        text = bench_dense.sequence_table("walk", {"left_over": 0.004, "left_over_of_people": 0.001, "found_again": 0.91,
                                                      "found_of_seen": 0.96, "insertion_ms": 20.0})
        self.assertEqual(missed(text), ["walk: empty room found again, %"])

    def test_growth_counts_from_the_second_pass(self):
        numbers = {"keyframes": [10, 20, 24], "landmarks": [10, 20, 25], "map_bytes": [1, 1, 1]}
        text = bench_map.growth(printing(numbers), "", "DIR", "FILE")[1]
        self.assertEqual(missed(text), ["landmarks: growth from pass 2 to 3"])

    def test_a_run_s_figures_are_those_of_its_summary(self):
        error = {"rmse": 0.01, "mean": 0.0, "max": 0.03}
        summary = {"frames": 40, "posed": 39, "keyframes": 5, "landmarks": 600, "ate_m": error,
                   "rpe_1s_translation_m": {"rmse": 0.02}, "mask": None,
                   "motion": {"mean_dynamic_share": 0.004}, "peak_memory_mb": 90.0, "start_s": 0.1,
                   "frames_in_state": {"OK": 40}, "dropped_late": 0, "latency_ms": None,
                   "stages": {"tracking": {"cpu_ms": {"median": 8.0, "p95": 12.0, "worst": 20.0}}}}
        with tempfile.TemporaryDirectory() as folder, mock.patch.object(bench, "run"):
            def write():
                with open(os.path.join(folder, "summary.json"), "w") as file:
                    json.dump(summary, file)
            write()
            result = bench.run_once("DIR", "FILE", folder)
            self.assertEqual((result["ate_rmse_m"], result["rpe_rmse_m"], result["mask_iou"]), (0.01, 0.02, None))
            self.assertEqual(result["cpu_ms"], {"tracking": (8.0, 12.0)})
            self.assertIn("97.5", bench.table({"DIR": [result]}))
            summary["ate_m"] = None
            write()
            with self.assertRaisesRegex(bench.BenchError, "DIR"):
                bench.run_once("DIR", "FILE", folder)

    def test_labels_alone_are_judged_where_nobody_is(self):
        asked = {}

        def run(mask_iou):
            def one(name, *options):
                asked[name] = options
                return [{"posed": 40, "frames": 40, "ate_rmse_m": 0.01, "rpe_rmse_m": 0.02, "mask_iou": mask_iou,
                         "mask_precision": mask_iou, "mask_recall": mask_iou, "dynamic_share": 0.004,
                         "cpu_ms": {"motion": (2.0, 3.0)}}]
            return one
        results, text = bench_motion.evidence(run(None), "n.onnx")
        self.assertEqual(list(results), ["none", "memory", "labels", "both", "labels only"])
        self.assertTrue(all(line.endswith("0.40") for line in text.splitlines()[1:]))
        for name, forgets, network in (("none", True, ""), ("memory", False, ""), ("labels", True, "n.onnx"),
                                       ("both", False, "n.onnx")):
            options = asked["evidence_" + name]
            self.assertEqual("motion.room.max_references=0" in options, forgets)
            self.assertIn("segmentation.model=" + network, options)
        self.assertEqual(list(bench_motion.evidence(run(0.8), "n.onnx")[0]), ["none", "memory", "labels", "both"])

    def test_depth_is_shifted_to_the_right_and_up(self):
        try:
            import numpy
        except ImportError:
            self.skipTest("numpy is not installed")
        depth = numpy.zeros((20, 30), numpy.uint16)
        depth[10, 10] = 5000
        shifted = bench_variations.depth_shifted(0, None, depth, None)[1]
        self.assertEqual([list(at) for at in numpy.argwhere(shifted)], [[8, 13]])

    def test_no_seeds_and_no_runs_are_refused(self):
        for option in ("--seeds", "--runs"):
            said = io.StringIO()
            with mock.patch.object(sys, "argv", ["bench", option, "0"]), contextlib.redirect_stderr(said), \
                    self.assertRaises(SystemExit):
                bench.parse_arguments()
            self.assertIn("must be 1 or more", said.getvalue())


if __name__ == "__main__":
    unittest.main()

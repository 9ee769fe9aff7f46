#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The semantic_vslam authors
# SPDX-License-Identifier: BSD-3-Clause
"""Runs run_offline over TUM sequences and prints accuracy and CPU time per stage as one table; behind `./run bench`.

Leaves the table in out/bench/bench.txt, the numbers in out/bench/bench.json, and each run's output beside them.
"""
import argparse
import csv
import json
import math
import os
import statistics
import subprocess
import sys

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
PROGRAMS = os.path.join(ROOT, "build", "release", "devel", "lib", "semantic_vslam")
DATA = os.path.join(os.environ.get("SEMANTIC_VSLAM_SHARED", os.path.join(ROOT, "..", "shared")), "data")
DEFAULT_SEQUENCES = ("tum_fr1_xyz", "walk_xyz")


class BenchError(Exception):
    """What went wrong and what to do, in one line."""


def run(command):
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, universal_newlines=True)
    if done.returncode != 0:
        lines = done.stderr.strip().splitlines() or ["no message"]
        raise BenchError(f"{os.path.basename(command[0])} on {command[1]}: {lines[-1]}")
    return done.stdout


def stage_times(path):
    """CPU ms per stage of one timing.csv: {stage: (median, 95th percentile)}, stages in order of appearance."""
    samples = {}
    with open(path) as file:
        for row in csv.DictReader(file):
            samples.setdefault(row["stage"], []).append(float(row["cpu_ms"]))
    return {stage: (statistics.median(ms), sorted(ms)[math.ceil(0.95 * len(ms)) - 1]) for stage, ms in samples.items()}


def run_once(sequence, camera, out_dir):
    run([os.path.join(PROGRAMS, "run_offline"), sequence, "--camera", camera, "--out", out_dir])
    trajectory = os.path.join(out_dir, "trajectory.txt")
    errors = json.loads(run([os.path.join(PROGRAMS, "evaluate_trajectory"), os.path.join(sequence, "groundtruth.txt"),
                             trajectory, "--json"]))
    with open(os.path.join(out_dir, "summary.json")) as file:
        summary = json.load(file)
    return {"frames": summary["frames"], "posed": summary["posed"], "keyframes": summary["keyframes"],
            "landmarks": summary["landmarks"], "ate_rmse_m": errors["ate_m"]["rmse"],
            "rpe_rmse_m": errors["rpe_translation_m"]["rmse"],
            "cpu_ms": stage_times(os.path.join(out_dir, "timing.csv"))}


def table(results):
    """`results`: {sequence: [one dict a run]}. Median over the runs; for the ATE also the worst."""
    lines = [f"{'sequence':16}{'runs':>5}{'posed %':>9}{'ATE mm':>9}{'worst':>8}{'RPE mm/s':>10}{'keyframes':>11}{'landmarks':>11}"]
    for name, runs in results.items():
        def median(key):
            return statistics.median(r[key] for r in runs)
        posed = 100 * statistics.median(r["posed"] / r["frames"] for r in runs)
        lines.append(f"{name:16}{len(runs):5}{posed:9.1f}{1e3 * median('ate_rmse_m'):9.1f}"
                     f"{1e3 * max(r['ate_rmse_m'] for r in runs):8.1f}{1e3 * median('rpe_rmse_m'):10.1f}"
                     f"{median('keyframes'):11.0f}{median('landmarks'):11.0f}")
    for name, runs in results.items():
        lines += ["", f"{name + ': CPU ms':34}{'median':>9}{'p95':>9}"]
        for stage in runs[0]["cpu_ms"]:
            times = [r["cpu_ms"][stage] for r in runs if stage in r["cpu_ms"]]
            lines.append(f"  {stage:32}{statistics.median(t[0] for t in times):9.2f}{statistics.median(t[1] for t in times):9.2f}")
    return "\n".join(lines) + "\n"


def parse_arguments():
    parser = argparse.ArgumentParser(prog="./run bench", description=__doc__.splitlines()[0])
    parser.add_argument("sequences", nargs="*", help="TUM folders (default: %s in ../shared/data)" % ", ".join(DEFAULT_SEQUENCES))
    parser.add_argument("--camera", default=os.path.join(ROOT, "cfg", "cameras", "tum_fr1.yaml"), help="camera of the sequences")
    parser.add_argument("--runs", type=int, default=5, help="runs of each sequence (default 5)")
    return parser.parse_args()


def main():
    arguments = parse_arguments()
    sequences = arguments.sequences or [os.path.join(DATA, name) for name in DEFAULT_SEQUENCES]
    for sequence in sequences:
        if not os.path.isfile(os.path.join(sequence, "groundtruth.txt")):
            raise BenchError(f"{sequence} is no TUM folder with a groundtruth.txt; give one: ./run bench DIR...")
    out_dir = os.path.join(ROOT, "out", "bench")
    results = {}
    for sequence in sequences:
        name = os.path.basename(os.path.normpath(sequence))
        for index in range(arguments.runs):
            print(f"[bench] {name}: run {index + 1} of {arguments.runs}", flush=True)
            run_dir = os.path.join(out_dir, name, str(index + 1))
            os.makedirs(run_dir, exist_ok=True)
            results.setdefault(name, []).append(run_once(sequence, arguments.camera, run_dir))
    text = table(results)
    with open(os.path.join(out_dir, "bench.txt"), "w") as file:
        file.write(text)
    with open(os.path.join(out_dir, "bench.json"), "w") as file:
        json.dump(results, file, indent=1)
    print(text, end="")


if __name__ == "__main__":
    try:
        main()
    except BenchError as error:
        sys.exit(f"[bench] FAILED: {error}")

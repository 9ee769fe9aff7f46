#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The semantic_vslam authors
# SPDX-License-Identifier: BSD-3-Clause
"""Runs run_offline over TUM sequences and prints accuracy and CPU time per stage as one table; behind `./run bench`.

Leaves the table in out/bench/bench.txt, the numbers in out/bench/bench.json, and each run's output beside them; a part
that is asked for by its option (see --help) likewise in files of its name.
"""
import argparse
import json
import os
import statistics
import subprocess
import sys

import bench_dense
import bench_map
import bench_motion
import bench_variations

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
PROGRAMS = os.path.join(ROOT, "build", "release", "devel", "lib", "semantic_vslam")
DATA = os.path.join(os.environ.get("SEMANTIC_VSLAM_SHARED", os.path.join(ROOT, "..", "shared")), "data")
DEFAULT_SEQUENCES = ("tum_fr1_xyz", "walk_xyz")
PACKAGE_NETWORK = "bisenetv2_indoor.onnx"


class BenchError(Exception):
    """What went wrong and what to do, in one line."""


def run(command):
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, universal_newlines=True)
    if done.returncode != 0:
        lines = done.stderr.strip().splitlines() or ["no message"]
        raise BenchError(f"{os.path.basename(command[0])} on {command[1]}: {lines[-1]}")
    return done.stdout


def run_once(sequence, camera, out_dir, options=()):
    run([os.path.join(PROGRAMS, "run_offline"), sequence, "--camera", camera, "--out", out_dir, *options])
    with open(os.path.join(out_dir, "summary.json")) as file:
        summary = json.load(file)
    if summary["ate_m"] is None or summary["rpe_1s_translation_m"] is None:
        raise BenchError(f"run_offline on {sequence}: too few frames with a pose to tell the trajectory's error")
    return {"frames": summary["frames"], "posed": summary["posed"], "keyframes": summary["keyframes"],
            "landmarks": summary["landmarks"], "ate_rmse_m": summary["ate_m"]["rmse"],
            "ate_worst_m": summary["ate_m"]["max"],
            "rpe_rmse_m": summary["rpe_1s_translation_m"]["rmse"],
            **{f"mask_{key}": (summary["mask"] or {}).get(key) for key in ("iou", "precision", "recall")},
            "dynamic_share": summary["motion"]["mean_dynamic_share"],
            "peak_memory_mb": summary["peak_memory_mb"], "start_s": summary["start_s"],
            "initialising": summary["frames_in_state"].get("INITIALISING", 0), "dropped_late": summary["dropped_late"],
            "latency_ms": summary["latency_ms"],
            "cpu_ms": {stage: (times["cpu_ms"]["median"], times["cpu_ms"]["p95"])
                       for stage, times in summary["stages"].items()}}


def table(results):
    """`results`: {sequence: [one dict a run]}. Median over the runs; for the ATE also the worst."""
    lines = [f"{'sequence':16}{'runs':>5}{'posed %':>9}{'ATE mm':>9}{'worst':>8}{'RPE mm/s':>10}{'keyframes':>11}{'landmarks':>11}"
             f"{'peak MB':>9}{'start s':>9}"]
    for name, runs in results.items():
        def median(key):
            return statistics.median(r[key] for r in runs)
        posed = 100 * statistics.median(r["posed"] / r["frames"] for r in runs)
        lines.append(f"{name:16}{len(runs):5}{posed:9.1f}{1e3 * median('ate_rmse_m'):9.1f}"
                     f"{1e3 * max(r['ate_rmse_m'] for r in runs):8.1f}{1e3 * median('rpe_rmse_m'):10.1f}"
                     f"{median('keyframes'):11.0f}{median('landmarks'):11.0f}"
                     f"{max(r['peak_memory_mb'] for r in runs):9.0f}{median('start_s'):9.2f}")
    for name, runs in results.items():
        lines += ["", f"{name + ': CPU ms':34}{'median':>9}{'p95':>9}"]
        for stage in runs[0]["cpu_ms"]:
            times = [r["cpu_ms"][stage] for r in runs if stage in r["cpu_ms"]]
            lines.append(f"  {stage:32}{statistics.median(t[0] for t in times):9.2f}{statistics.median(t[1] for t in times):9.2f}")
    return "\n".join(lines) + "\n"


def positive(text):
    number = int(text)
    if number < 1:
        raise argparse.ArgumentTypeError("must be 1 or more")
    return number


def variation_names(text):
    names = text.split(",")
    unknown = [name for name in names if name not in bench_variations.NAMES]
    if unknown:
        raise argparse.ArgumentTypeError("there is no variation " + ", ".join(unknown))
    return names


def parse_arguments():
    parser = argparse.ArgumentParser(prog="./run bench", description=__doc__.splitlines()[0])
    parser.add_argument("sequences", nargs="*", help="TUM folders (default: %s in ../shared/data)" % ", ".join(DEFAULT_SEQUENCES))
    parser.add_argument("--camera", default=os.path.join(ROOT, "cfg", "cameras", "tum_fr1.yaml"), help="camera of the sequences")
    parser.add_argument("--runs", type=positive, help="runs of each sequence (default 5; 1 for a part, whose runs give the same)")
    parser.add_argument("--network", default=PACKAGE_NETWORK,
                        help="semantic network, .onnx; '' for none (default %(default)s)")
    part = parser.add_mutually_exclusive_group()
    for name, function in {**bench_motion.PARTS, "loops": bench_map.loops, **bench_map.PARTS}.items():
        part.add_argument("--" + name, dest="part", action="store_const", const=name, help=function.__doc__)
    part.add_argument("--variations", dest="part", action="store_const", const="variations",
                      help="Each sequence backwards, from other frames, slower, and with worse pictures, without a network "
                           "and with it")
    part.add_argument("--dense", dest="part", action="store_const", const="dense", help=bench_dense.dense.__doc__)
    part.add_argument("--publishing", dest="part", action="store_const", const="publishing",
                      help=bench_dense.publishing.__doc__)
    part.add_argument("--backend", dest="part", action="store_const", const="backend",
                      help="All figures of the first sequence and its map in one table, with --places, --recovery, "
                           "--growth and --loops, each beside what is asked. Takes hours with all --seeds")
    parser.add_argument("--seeds", type=positive, default=bench_map.LOOP_SEEDS, help="seeds of --loops (default %(default)s)")
    parser.add_argument("--only", type=variation_names, default=bench_variations.NAMES, metavar="NAME,...",
                        help="those of --variations: " + ", ".join(bench_variations.NAMES))
    parser.add_argument("--frames", type=positive, help="frames of each sequence that --variations takes")
    return parser.parse_args()


def run_part(name, sequences, camera, runs, network, out_dir):
    """One of bench_motion.PARTS over the sequences. @return numbers, text"""
    results, text = {}, ""
    for sequence in sequences:
        label = os.path.basename(os.path.normpath(sequence))

        def run_variant(variant, *options):
            outcomes = []
            for index in range(runs):
                print(f"[bench] {label}: {variant}, run {index + 1} of {runs}", flush=True)
                run_dir = os.path.join(out_dir, label, variant, str(index + 1))
                os.makedirs(run_dir, exist_ok=True)
                outcomes.append(run_once(sequence, camera, run_dir, options))
            return outcomes
        results[label], table_text = bench_motion.PARTS[name](run_variant, network)
        text += f"{label}, network: {os.path.basename(network) or 'none'}\n{table_text}\n\n"
    return results, text


def run_variations(sequences, camera, network, names, frames, out_dir):
    """@return numbers, text"""
    results, text = {}, ""
    for sequence in sequences:
        label = os.path.basename(os.path.normpath(sequence))
        for model in ("", network) if network else ("",):
            title = f"{label}, network: {os.path.basename(model) or 'none'}"
            options = bench_motion.SPARSE + bench_motion.settings(segmentation__model=model)
            run_dir = os.path.join(out_dir, label, "variations_" + (os.path.basename(model) or "none"))
            results[title], part = bench_variations.variations(run_once, sequence, camera, options, names, frames, run_dir,
                                                               lambda name, t=title: print(f"[bench] {t}: {name}", flush=True))
            text += f"{title}\n{part}\n\n"
    return results, text


def run_table(sequences, camera, runs, network, out_dir):
    results, options = {}, bench_motion.settings(segmentation__model=network)
    for sequence in sequences:
        name = os.path.basename(os.path.normpath(sequence))
        for index in range(runs):
            print(f"[bench] {name}: run {index + 1} of {runs}", flush=True)
            run_dir = os.path.join(out_dir, name, str(index + 1))
            os.makedirs(run_dir, exist_ok=True)
            results.setdefault(name, []).append(run_once(sequence, camera, run_dir, options))
    return results


def run_map_part(name, sequence, camera, seeds):
    """One of the parts about the map. @return numbers, text"""
    def say(line):
        print(f"[bench] {line}", flush=True)
    if name == "loops":
        return bench_map.loops(run, PROGRAMS, say, range(1, seeds + 1))
    return bench_map.PARTS[name](run, PROGRAMS, sequence, camera)


def run_backend(sequence, camera, runs, seeds, out_dir):
    """Everything about the map, without a network. @return numbers, text"""
    label = os.path.basename(os.path.normpath(sequence))
    results = {label: run_table([sequence], camera, runs, "", out_dir)[label]}
    text = f"{label}\n" + bench_map.figures(results[label])
    for name in (*bench_map.PARTS, "loops"):
        print(f"[bench] {name}", flush=True)
        results[name], part = run_map_part(name, sequence, camera, seeds)
        text += f"\n{name}\n{part}"
    return results, text


def main():
    arguments = parse_arguments()
    sequences = arguments.sequences or [os.path.join(DATA, name) for name in DEFAULT_SEQUENCES]
    for sequence in sequences:
        if not os.path.isfile(os.path.join(sequence, "groundtruth.txt")):
            raise BenchError(f"{sequence} is no TUM folder with a groundtruth.txt; give one: ./run bench DIR...")
    out_dir = os.path.join(ROOT, "out", "bench")
    os.makedirs(out_dir, exist_ok=True)
    if arguments.part == "loops" or arguments.part in bench_map.PARTS:
        results, text = run_map_part(arguments.part, sequences[0], arguments.camera, arguments.seeds)
    elif arguments.part == "variations":
        results, text = run_variations(sequences, arguments.camera, arguments.network, arguments.only, arguments.frames, out_dir)
    elif arguments.part == "dense":
        results, text = bench_dense.dense(run, PROGRAMS, lambda line: print(f"[bench] {line}", flush=True), out_dir, sequences,
                                          arguments.camera, os.path.join(DATA, DEFAULT_SEQUENCES[0]))
    elif arguments.part == "publishing":
        results, text = bench_dense.publishing(run, PROGRAMS)
    elif arguments.part == "backend":
        results, text = run_backend(sequences[0], arguments.camera, arguments.runs or 1, arguments.seeds, out_dir)
    elif arguments.part:
        results, text = run_part(arguments.part, sequences, arguments.camera, arguments.runs or 1, arguments.network, out_dir)
    else:
        results = run_table(sequences, arguments.camera, arguments.runs or 5, arguments.network, out_dir)
        text = table(results)
    name = os.path.join(out_dir, arguments.part or "bench")
    with open(name + ".txt", "w") as file:
        file.write(text)
    with open(name + ".json", "w") as file:
        json.dump(results, file, indent=1)
    print(text, end="")


if __name__ == "__main__":
    try:
        main()
    except BenchError as error:
        sys.exit(f"[bench] FAILED: {error}")

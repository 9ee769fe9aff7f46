# SPDX-FileCopyrightText: 2026 The semantic_vslam authors
# SPDX-License-Identifier: BSD-3-Clause
"""The part of `./run bench` about the dense map: `measure_map` over rendered rooms and over sequences with people."""
import json
import os
import statistics

ROOMS = tuple((scenario, seed) for seed in (1, 2) for scenario in ("static", "walking", "sitting", "pause", "pushed_chair"))
CLASSES = ("chair", "monitor", "table")
LEAST_NEAR, MOST_BEYOND, LEAST_LABELS_RIGHT = 0.95, 0.01, 0.98
MOST_LEFT_OVER, LEAST_FOUND_AGAIN = 0.005, 0.95
MOST_CENTROID_M = 0.10
MOST_INSERTION_MS = 25
MOST_PUBLISHING_MS = 10
MAN_OF_FR1 = "-1.2,0.3,0.5,-0.6,1.15,1.6"  # a man sits behind the monitors of freiburg1_xyz all the time


def _row(what, value, bound, good):
    return f"{what:48}{value:>22}   {bound:28}{'' if good else '*'}"


def _measure(run, programs, folder, options):
    os.makedirs(folder, exist_ok=True)
    run([os.path.join(programs, "measure_map"), *options, "--out", folder])
    with open(os.path.join(folder, "map.json")) as file:
        return json.load(file)


def rooms_table(rooms):
    """`rooms`: the map.json of each. @return text"""
    def median_and(worst, values, scale=100.0):
        return f"{scale * statistics.median(values):.2f}, {scale * worst(values):.2f}"
    near = [r["points_within_2cm"] for r in rooms]
    beyond = [r["voxels_beyond_5cm"] for r in rooms]
    labels = [r["labels_right"] for r in rooms]
    on_obstacle = [r["grid"]["free_on_obstacle"] for r in rooms]
    times = [r["insertion_ms"] for r in rooms]
    lines = [
        _row("points within 2 cm, % (median, worst)", median_and(min, near), "at least 95", min(near) >= LEAST_NEAR),
        _row("voxels beyond 5 cm of anything, %", median_and(max, beyond), "at most 1", max(beyond) <= MOST_BEYOND),
        _row("  of people", median_and(max, [r["voxels_of_people"] for r in rooms]), "", True),
        _row("seen surface found within 3 cm, %", median_and(min, [r["surface_found"] for r in rooms]), "", True),
        _row("labels over voxels", median_and(min, labels, 1.0), "at least 0.98", min(labels) >= LEAST_LABELS_RIGHT),
        _row("free cells on obstacles (all rooms)", str(sum(on_obstacle)), "none", sum(on_obstacle) == 0),
        _row("free cells (all rooms)", str(sum(r["grid"]["free"] for r in rooms)), "", True),
        _row("insertion, CPU ms a keyframe (median, worst)", median_and(max, times, 1.0), f"at most {MOST_INSERTION_MS}",
             statistics.median(times) <= MOST_INSERTION_MS)]
    for name in CLASSES:
        scores = [r["objects"][name] for r in rooms if name in r["objects"]]
        things, once = (sum(s[key] for s in scores) for key in ("things", "listed_once"))
        errors = [e for s in scores for e in s["centroid_error_m"]] or [0.0]
        lines.append(_row(f"{name}: listed once; centroid off, m (mid, worst)",
                          f"{once} of {things}; {statistics.median(errors):.2f}, {max(errors):.2f}", "all; at most 0.10",
                          once == things and max(errors) <= MOST_CENTROID_M))
    return "\n".join(lines) + "\n"


def sequence_table(name, numbers):
    """@return text"""
    return "\n".join([
        _row(f"{name}: farther than 5 cm from the empty map, %", f"{100 * numbers['left_over']:.2f}", "at most 0.5",
             numbers["left_over"] <= MOST_LEFT_OVER),
        _row("  from anything measured in it", f"{100 * numbers['left_over_of_people']:.2f}", "", True),
        _row(f"{name}: empty room found again, %", f"{100 * numbers['found_again']:.2f}", "at least 95",
             numbers["found_again"] >= LEAST_FOUND_AGAIN),
        _row("  of what was seen past the people", f"{100 * numbers['found_of_seen']:.2f}", "", True),
        _row("  insertion, CPU ms a keyframe (median)", f"{numbers['insertion_ms']:.1f}", f"at most {MOST_INSERTION_MS}",
             numbers["insertion_ms"] <= MOST_INSERTION_MS)]) + "\n"


def dense(run, programs, say, out_dir, sequences, camera, empty):
    """The dense map (a quarter of an hour): ten rendered rooms against their exact geometry, and each sequence but the first default one
    against the map of that one's empty room."""
    results, text = {"rooms": []}, ""
    for scenario, seed in ROOMS:
        say(f"{scenario}, seed {seed}")
        results["rooms"].append(_measure(run, programs, os.path.join(out_dir, "dense", f"{scenario}_{seed}"),
                                         ("--scenario", scenario, "--seed", str(seed), "--true-labels")))
    text += rooms_table(results["rooms"])
    for sequence in sequences:
        if os.path.realpath(sequence) == os.path.realpath(empty):
            continue
        name = os.path.basename(os.path.normpath(sequence))
        say(name)
        options = [sequence, "--camera", camera, "--empty", empty]
        if os.path.basename(os.path.realpath(empty)) == "tum_fr1_xyz":
            options.append("--leave-out=" + MAN_OF_FR1)
        results[name] = _measure(run, programs, os.path.join(out_dir, "dense", name), options)
        text += sequence_table(name, results[name])
    return results, text


def publishing(run, programs):
    """What it costs to publish the dense map, against its size (ten minutes): CPU ms of each message the first time, and after
    about 1 % of the map has changed."""
    sizes = list(json.loads(run([os.path.join(programs, "measure_publishing"), "--rooms", "4"])).values())
    lines = [f"{'':34}" + "".join(f"{size['floor_m2']:14.0f} m2" for size in sizes)]
    for key, scale, what in (("voxels", 1e-6, "voxels, millions"), ("points", 1e-6, "points, millions"),
                             ("memory_mb", 1.0, "memory, MB"), ("blocks_changed", 100.0, "blocks that changed, %"),
                             ("insertion_ms", 1.0, "insertion of the change, ms")):
        lines.append(f"{what:34}" + "".join(f"{scale * size[key]:17.2f}" for size in sizes))
    lines.append(f"CPU ms, at first and after a change (* more than {MOST_PUBLISHING_MS})")
    for topic in sizes[0]["first_ms"]:
        after = [size["after_change_ms"][topic] for size in sizes]
        lines.append(f"{topic:34}" + "".join(f"{size['first_ms'][topic]:9.1f}{ms:7.1f}{'*' if ms > MOST_PUBLISHING_MS else ' '}"
                                             for size, ms in zip(sizes, after)))
    return {"sizes": sizes}, "\n".join(lines) + "\n"

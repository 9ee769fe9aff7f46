# SPDX-FileCopyrightText: 2026 The semantic_vslam authors
# SPDX-License-Identifier: BSD-3-Clause
"""Parts of `./run bench` about people in the picture. Each takes `run(name, *options)`, which runs run_offline on one
sequence and returns a list of results, one a run, and the semantic network's file or ""; it returns {row: results} and text."""
import statistics

STARTS = 20
# Starts lie in this share of the recording, so that enough of it is left to judge a trajectory by.
STARTS_WITHIN = 0.8
MOST_FRAMES_TO_INITIALISE = 15
MOST_ATE_OF_MEDIAN = 1.3
# Later than any recording is long: no mask ever arrives.
NEVER_S = 60
MASK_DELAYS_S = (0, 0.3, 1, NEVER_S)


def settings(**values):
    """--set options; `__` stands for the dot of a key."""
    return [word for key, value in values.items() for word in ("--set", f"{key.replace('__', '.')}={value}")]


# The dense map is not looked at and has no say in the pose.
SPARSE = settings(dense__enabled="false")


def median_of(runs, key):
    values = [run[key] for run in runs if run[key] is not None]
    return statistics.median(values) if values else None


def number(value, form, width, scale=1.0):
    return f"{'-':>{width}}" if value is None else f"{scale * value:{width}{form}}"


HEADER = (f"{'posed %':>9}{'ATE mm':>9}{'RPE mm/s':>10}{'mask IoU':>10}{'precision':>11}{'recall':>8}"
          f"{'motion CPU ms':>15}{'p95':>7}")


def row(runs):
    cpu = [run["cpu_ms"]["motion"] for run in runs]
    posed = statistics.median(run["posed"] / run["frames"] for run in runs)
    return (number(posed, ".1f", 9, 100) + number(median_of(runs, "ate_rmse_m"), ".1f", 9, 1e3)
            + number(median_of(runs, "rpe_rmse_m"), ".1f", 10, 1e3) + number(median_of(runs, "mask_iou"), ".3f", 10)
            + number(median_of(runs, "mask_precision"), ".3f", 11) + number(median_of(runs, "mask_recall"), ".3f", 8)
            + f"{statistics.median(c[0] for c in cpu):15.2f}{statistics.median(c[1] for c in cpu):7.2f}")


def ablation(run, network):
    """What each way of finding what moves gives. "both" is the default motion model with the network."""
    variants = {"none": settings(motion__model="none", segmentation__model=""),
                "homography": settings(motion__model="homography", segmentation__model=""),
                "rigid flow": settings(motion__model="rigid_flow", segmentation__model="")}
    if network:
        variants["semantics"] = settings(motion__model="none", segmentation__model=network)
        variants["both"] = settings(motion__model="rigid_flow", segmentation__model=network)
    results = {name: run("ablation_" + name.replace(" ", "_"), *SPARSE, *options) for name, options in variants.items()}
    return results, "\n".join([f"{'':12}" + HEADER] + [f"{name:12}" + row(runs) for name, runs in results.items()])


def evidence(run, network):
    """What the map's memory of the room and the labels give, each alone and both (the default)"""
    forgets = settings(motion__room__max_references=0)
    variants = {"none": forgets + settings(segmentation__model=""), "memory": settings(segmentation__model="")}
    if network:
        variants["labels"] = forgets + settings(segmentation__model=network)
        variants["both"] = settings(segmentation__model=network)
    results = {name: run("evidence_" + name, *SPARSE, *options) for name, options in variants.items()}
    if network and median_of(results["none"], "mask_iou") is None:
        # Nobody is in the recording: what labels alone call dynamic are pixels falsely called a person.
        results["labels only"] = run("evidence_labels_only", *SPARSE,
                                     *settings(motion__model="none", segmentation__model=network))
    lines = [f"{'':12}" + HEADER + f"{'dynamic %':>11}"]
    lines += [f"{name:12}" + row(runs) + number(median_of(runs, "dynamic_share"), ".2f", 11, 100)
              for name, runs in results.items()]
    return results, "\n".join(lines)


def delays(run, network):
    """Masks that come late, or never. The last row has no network at all: what lost masks must come down to."""
    results = {}
    if network:
        for delay_s in MASK_DELAYS_S:
            name = "never" if delay_s == NEVER_S else f"{delay_s} s late" if delay_s else "at once"
            results[name] = run(f"delay_{delay_s}", *SPARSE, *settings(segmentation__model=network, label_delay_s=delay_s))
    results["motion only"] = run("delay_motion_only", *SPARSE, *settings(segmentation__model=""))
    lines = [f"{'masks':12}" + HEADER] + [f"{name:12}" + row(runs) for name, runs in results.items()]
    if network:
        at_once = median_of(results["at once"], "ate_rmse_m")
        worst = max(median_of(results[name], "ate_rmse_m") for name in ("0.3 s late", "1 s late"))
        lines.append(f"late masks raise the ATE by {100 * (worst / at_once - 1):.0f} % at most (bound: 20 %)")
    return results, "\n".join(lines)


def starts(run, network):
    """The same recording from frames spread over it, each to the end."""
    model = SPARSE + settings(segmentation__model=network)
    whole = run("start_0", *model)
    frames = whole[0]["frames"]
    results = {0: whole}
    for index in range(1, STARTS):
        first = int(index * STARTS_WITHIN * frames / STARTS)
        results[first] = run(f"start_{first}", "--start", str(first), *model)
    ate_m = {first: median_of(runs, "ate_rmse_m") for first, runs in results.items()}
    middle = statistics.median(ate_m.values())
    lines = [f"{'first frame':>12}{'initialised after':>19}{'posed %':>9}{'ATE mm':>9}{'of median':>11}"]
    bad = 0
    for first, runs in results.items():
        waited = max(r["initialising"] for r in runs)
        good = waited <= MOST_FRAMES_TO_INITIALISE and ate_m[first] <= MOST_ATE_OF_MEDIAN * middle
        bad += 0 if good else 1
        posed = statistics.median(r["posed"] / r["frames"] for r in runs)
        lines.append(f"{first:12}{waited:19}{100 * posed:9.1f}{1e3 * ate_m[first]:9.1f}{ate_m[first] / middle:11.2f}"
                     + ("" if good else "  *"))
    lines.append(f"{bad} of {len(results)} starts take more than {MOST_FRAMES_TO_INITIALISE} frames to initialise or end "
                 f"above {MOST_ATE_OF_MEDIAN} times the median ATE (*)")
    return results, "\n".join(lines)


def realtime(run, network):
    """At the pace of the stamps, with mapping and segmentation beside tracking, and without a network."""
    variants = {"motion only": ""}
    if network:
        variants["with network"] = network
    results = {name: run("realtime_" + name.replace(" ", "_"), "--realtime", *settings(segmentation__model=model))
               for name, model in variants.items()}
    lines = [f"{'':12}" + HEADER + f"{'dropped %':>11}{'pose after ms':>15}{'p95':>6}{'worst':>7}"]
    for name, runs in results.items():
        dropped = statistics.median(r["dropped_late"] / (r["frames"] + r["dropped_late"]) for r in runs)
        after = [statistics.median(r["latency_ms"][key] for r in runs) for key in ("median", "p95", "worst")]
        lines.append(f"{name:12}" + row(runs) + f"{100 * dropped:11.1f}{after[0]:15.0f}{after[1]:6.0f}{after[2]:7.0f}")
    lines.append("frames dropped: at most 1 % keeps 30 frames a second")
    return results, "\n".join(lines)


PARTS = {"ablation": ablation, "evidence": evidence, "delays": delays, "starts": starts, "realtime": realtime}

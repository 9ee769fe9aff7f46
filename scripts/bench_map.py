# SPDX-FileCopyrightText: 2026 The semantic_vslam authors
# SPDX-License-Identifier: BSD-3-Clause
"""The parts of `./run bench` about the map as a whole: loops in rendered rooms, and growth over many passes."""
import concurrent.futures
import json
import os
import statistics

LOOP_SEEDS = 20
LEAST_LOOPS_FOUND = 19
MOST_ATE_MM = 30
MOST_SHARE_OF_BEFORE = 1 / 3
CORRIDORS = ("corridor", "corridor_identical")  # seeds take turns
MOST_GROWTH = 0.20

# Every second frame of a 30 Hz camera: a seed takes two to three minutes of CPU time, most of it to render.
RENDERING = ("--size", "640x480", "--fps", "15")


def _median_and_worst(values):
    return f"{statistics.median(values):.1f}, {max(values):.1f}" if values else "-"


def _row(what, value, bound, good):
    return f"{what:48}{value:>22}   {bound:28}{'' if good else '*'}"


def _run_seeds(run, program, scenarios, seeds, say):
    """measure_loops over the seeds, as many at once as there are processors. @return one dict a seed"""
    def one(seed):
        scenario = scenarios[seed % len(scenarios)]
        numbers = json.loads(run([program, "--scenario", scenario, "--seed", str(seed), *RENDERING]))
        say(f"{scenario} {seed}: {numbers['posed']}/{numbers['frames']} posed, {numbers['loops']} loops, "
            f"{numbers['false_loops']} false, ATE {1e3 * numbers['ate_m']:.0f} mm, {numbers['cpu_s']:.0f} s CPU")
        return {"seed": seed, **numbers}
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        return list(pool.map(one, seeds))


def loops(run, programs, say, seeds):
    """A rendered loop of 42 m and a corridor of look-alike rooms, 20 seeds each (--seeds): loops found, false ones, and
    the ATE just before the first closing and at the end."""
    program = os.path.join(programs, "measure_loops")
    rounds = _run_seeds(run, program, ("loop",), seeds, say)
    corridors = _run_seeds(run, program, CORRIDORS, seeds, say)
    found = [r for r in rounds if r["loops"] and not r["false_loops"]]
    after = [1e3 * r["ate_m"] for r in found]
    share = [r["ate_m"] / r["ate_before_m"] for r in found]
    false = sum(r["false_loops"] for r in rounds + corridors)
    lines = [
        _row("loop: seeds in which it is found", f"{len(found)} of {len(rounds)}", "at least 19 of 20",
             len(found) >= LEAST_LOOPS_FOUND / LOOP_SEEDS * len(rounds)),
        _row("loop: ATE before, mm (median, worst)", _median_and_worst([1e3 * r["ate_before_m"] for r in found]), "", True),
        _row("loop: ATE after, mm (median, worst)", _median_and_worst(after), f"at most {MOST_ATE_MM}",
             bool(after) and max(after) <= MOST_ATE_MM),
        _row("loop: after / before, % (median, worst)", _median_and_worst([100 * s for s in share]), "at most 33",
             bool(share) and max(share) <= MOST_SHARE_OF_BEFORE),
        _row("loop: frames posed, % (median, worst)",
             f"{100 * statistics.median(r['posed'] / r['frames'] for r in rounds):.1f}, "
             f"{100 * min(r['posed'] / r['frames'] for r in rounds):.1f}", "", True),
        _row("corridor: ATE, mm (median, worst)", _median_and_worst([1e3 * r["ate_m"] for r in corridors]), "", True),
        _row(f"false loops in {len(rounds)} + {len(corridors)} seeds", str(false), "none", false == 0)]
    return {"loop": rounds, "corridor": corridors}, "\n".join(lines) + "\n"


def growth(run, programs, sequence, camera):
    """Ten passes over the first sequence, back and forth: how the map grows after the second."""
    numbers = json.loads(run([os.path.join(programs, "measure_growth"), sequence, "--camera", camera]))
    lines = []
    for what in ("keyframes", "landmarks", "map_bytes"):
        sizes = numbers[what]
        grown = sizes[-1] / sizes[1] - 1
        lines.append(_row(f"{what.replace('_', ' ')}: growth from pass 2 to {len(sizes)}", f"{100 * grown:.0f} %",
                          f"at most {100 * MOST_GROWTH:.0f} %", grown <= MOST_GROWTH))
    return numbers, "\n".join(lines) + "\n"

# SPDX-FileCopyrightText: 2026 The semantic_vslam authors
# SPDX-License-Identifier: BSD-3-Clause
"""The part of `./run bench` about lost sight and saved maps: what measure_recovery says of one sequence, as a table."""
import json

LEAST_SHARE_RECOVERED = 0.96
MOST_FRAMES_NEEDED = 10
MOST_ATE_MM = 12
MOST_START_S = 1


def recovery(run, program, sequence, camera, options=()):
    """Cuts of 1 to 3 s, the lens covered for good, and localisation in the saved map.

    `run` runs a command and returns what it prints. @return numbers, text"""
    out = run([program, sequence, "--camera", camera, *options])
    at = out.index("\n{") + 1
    numbers = json.loads(out[at:])
    cuts, saved = numbers["cuts"], numbers["saved_map"]
    lines = [out[:at]]

    def line(what, value, bound, good):
        lines.append(f"{what:48}{value:>22}   {bound:28}{'' if good else '*'}")
    line("cuts: posed again within 10 frames", f"{cuts['back_within_10_frames']} of {cuts['count']}", "at least 96 %",
         cuts["back_within_10_frames"] >= LEAST_SHARE_RECOVERED * cuts["count"])
    line("cuts: wrong place (over 0.05 m off)", str(cuts["wrong_place"]), "none", cuts["wrong_place"] == 0)
    kept = numbers["covered_for_good_is_lost_and_keeps_map"]
    line("covered for good: LOST, and the map stays", "yes" if kept else "no", "yes", kept)
    if saved["ate_m"]:
        needed = saved["frames_needed"]
        late = min(needed) < 0 or max(needed) > MOST_FRAMES_NEEDED
        line("saved map: posed after, frames", ", ".join(f"{n:.0f}" for n in needed), "at most 10", not late)
        ate_mm = [1e3 * ate for ate in saved["ate_m"]]
        line("saved map: ATE, mm", ", ".join(f"{mm:.1f}" for mm in ate_mm), f"at most {MOST_ATE_MM}", max(ate_mm) <= MOST_ATE_MM)
        line("saved map: its bytes unchanged", "yes" if saved["bytes_unchanged"] else "no", "yes", saved["bytes_unchanged"])
        line("start-up with the map, s", f"{saved['start_s']:.2f}", f"under {MOST_START_S}", saved["start_s"] < MOST_START_S)
    return numbers, "\n".join(lines) + "\n"

# SPDX-FileCopyrightText: 2026 The semantic_vslam authors
# SPDX-License-Identifier: BSD-3-Clause
"""`./run bench --variations DIR...`: the same recording in other circumstances. Each variation is a TUM folder derived from
the recording's in a temporary place: only the stamps differ, or the pictures are changed as a worse camera would."""
import os
import random
import tempfile

MOST_OF_BASE = 2.0
MOST_OK_ERROR_M = 0.08
STARTS = 10
# Starts lie in this share of the recording, so that enough of it is left to judge a trajectory by.
STARTS_WITHIN = 0.6
# Standard deviation of the recordings' own depth (structured light), metres at z metres: added sqrt(3) times, it doubles.
NOISE_AT_0_4_M, NOISE_PER_M2, NOISE_FROM_M = 0.0012, 0.0019, 0.4
TUM_DEPTH_PER_M = 5000.0


class Frame:
    """One row of a recording: stamps in seconds, files relative to it; `mask` may be None."""

    def __init__(self, rgb_s, rgb, depth_s, depth, mask):
        self.rgb_s, self.rgb, self.depth_s, self.depth, self.mask = rgb_s, rgb, depth_s, depth, mask


def read_frames(folder):
    frames = []
    with open(os.path.join(folder, "associations.txt")) as file:
        for line in file:
            words = line.split()
            if not words or words[0].startswith("#"):
                continue
            mask = os.path.join("mask", words[0] + ".png")
            frames.append(Frame(float(words[0]), words[1], float(words[2]), words[3],
                                mask if os.path.isfile(os.path.join(folder, mask)) else None))
    return frames


def read_truth(folder):
    """@return [[stamp_s, "x y z qx qy qz qw"]]"""
    with open(os.path.join(folder, "groundtruth.txt")) as file:
        rows = [line.split(None, 1) for line in file if line.strip() and not line.startswith("#")]
    return [[float(stamp), rest.strip()] for stamp, rest in rows]


def write_folder(source, frames, truth, out, change=None):
    """@param change  (frame index, bgr, depth, mask or None) -> the same three, changed; None: files are linked"""
    for name in ("rgb", "depth", "mask"):
        os.makedirs(os.path.join(out, name))
    lines = []
    for index, frame in enumerate(frames):
        stamp = f"{frame.rgb_s:.6f}"
        files = {"rgb": (frame.rgb, f"rgb/{stamp}" + os.path.splitext(frame.rgb)[1]),
                 "depth": (frame.depth, f"depth/{index:06d}.png"), "mask": (frame.mask, f"mask/{stamp}.png")}
        if change is None:
            for old, new in files.values():
                if old:
                    os.symlink(os.path.join(os.path.abspath(source), old), os.path.join(out, new))
        else:
            _write_changed(source, files, out, lambda *images, i=index: change(i, *images))
        lines.append(f"{stamp} {files['rgb'][1]} {frame.depth_s:.6f} {files['depth'][1]}\n")
    with open(os.path.join(out, "associations.txt"), "w") as file:
        file.writelines(lines)
    with open(os.path.join(out, "groundtruth.txt"), "w") as file:
        file.writelines(f"{stamp:.6f} {rest}\n" for stamp, rest in truth)
    if not os.listdir(os.path.join(out, "mask")):
        os.rmdir(os.path.join(out, "mask"))


def _write_changed(source, files, out, change):
    import cv2
    images = [cv2.imread(os.path.join(source, old), flag) if old else None
              for (old, _), flag in zip(files.values(), (cv2.IMREAD_COLOR, cv2.IMREAD_UNCHANGED, cv2.IMREAD_GRAYSCALE))]
    for (_, new), image in zip(files.values(), change(*images)):
        if image is not None:
            options = [cv2.IMWRITE_PNG_COMPRESSION, 1] if new.endswith(".png") else [cv2.IMWRITE_JPEG_QUALITY, 95]
            cv2.imwrite(os.path.join(out, new), image, options)


def backwards(frames, truth):
    total = frames[0].rgb_s + frames[-1].rgb_s
    turned = [Frame(total - f.rgb_s, f.rgb, total - f.depth_s, f.depth, f.mask) for f in reversed(frames)]
    return turned, [[total - stamp, rest] for stamp, rest in reversed(truth)]


def every(step):
    return lambda frames, truth: (frames[::step], truth)


def depth_late(frames, truth):
    """The depth image of the frame before, with the stamp that it should not have."""
    return [Frame(f.rgb_s, f.rgb, f.depth_s, before.depth, f.mask) for before, f in zip(frames, frames[1:])], truth


def noise(index, bgr, depth, mask):
    import numpy
    rng = numpy.random.default_rng(index)
    z = depth / TUM_DEPTH_PER_M
    sigma = 3 ** 0.5 * (NOISE_AT_0_4_M + NOISE_PER_M2 * (z - NOISE_FROM_M) ** 2)
    noisy = numpy.clip((z + sigma * rng.standard_normal(z.shape)) * TUM_DEPTH_PER_M, 1, 65535)
    return bgr, numpy.where(depth > 0, noisy, 0).astype(numpy.uint16), mask


def holes(index, bgr, depth, mask):
    """Depth is missing in a dozen ellipses that stay for half a second each, about a fifth of the image."""
    import cv2
    rng = random.Random(index // 15)
    height, width = depth.shape
    for _ in range(12):
        centre = (rng.randrange(width), rng.randrange(height))
        axes = (int(width * rng.uniform(0.03, 0.12)), int(height * rng.uniform(0.03, 0.12)))
        cv2.ellipse(depth, centre, axes, rng.uniform(0, 180), 0, 360, 0, -1)
    return bgr, depth, mask


def dark(index, bgr, depth, mask):
    import numpy
    rng = numpy.random.default_rng(index)
    image = 0.3 * bgr + rng.normal(0, 3, bgr.shape)
    return numpy.clip(image, 0, 255).astype(numpy.uint8), depth, mask


def flicker(index, bgr, depth, mask):
    import numpy
    gain = random.Random(index).uniform(0.7, 1.3)
    return numpy.clip(gain * bgr.astype(numpy.float32), 0, 255).astype(numpy.uint8), depth, mask


def blur(index, bgr, depth, mask):
    """An exposure over 9 px of motion, in a direction that turns."""
    import cv2
    import numpy
    kernel = numpy.zeros((9, 9), numpy.float32)
    angle = 0.1 * index
    for step in numpy.linspace(-4, 4, 33):
        kernel[int(round(4 + step * numpy.sin(angle))), int(round(4 + step * numpy.cos(angle)))] += 1
    return cv2.filter2D(bgr, -1, kernel / kernel.sum()), depth, mask


def depth_shifted(index, bgr, depth, mask):
    """Depth that lies 3 px to the right and 2 px above of where colour shows it: a camera that is registered badly."""
    import numpy
    shifted = numpy.zeros_like(depth)
    shifted[:-2, 3:] = depth[2:, :-3]
    return bgr, shifted, mask


def quarter(index, bgr, depth, mask):
    """320x240: colour by area, depth every second pixel."""
    import cv2
    half = (bgr.shape[1] // 2, bgr.shape[0] // 2)
    return (cv2.resize(bgr, half, interpolation=cv2.INTER_AREA), depth[::2, ::2].copy(),
            None if mask is None else mask[::2, ::2].copy())


def _keep(frames, truth):
    return frames, truth


# name: (frames and truth -> the same, changed; change of the pictures or None)
VARIATIONS = {"backwards": (backwards, None), "15 Hz": (every(2), None), "10 Hz": (every(3), None),
              "noise x 2": (_keep, noise), "holes": (_keep, holes), "dark": (_keep, dark), "flicker": (_keep, flicker),
              "blur": (_keep, blur), "depth late": (depth_late, None),
              "depth 3 px off": (_keep, depth_shifted), "320x240": (_keep, quarter)}
NAMES = ("starts", *VARIATIONS)


def half_camera(camera, out):
    """The calibration of the image at half its width and height."""
    with open(camera) as file:
        lines = file.readlines()
    with open(out, "w") as file:
        for line in lines:
            key, _, value = line.partition(":")
            if key in ("width", "height"):
                line = f"{key}: {int(value) // 2}\n"
            elif key in ("fx", "fy"):
                line = f"{key}: {float(value) / 2}\n"
            elif key in ("cx", "cy"):
                line = f"{key}: {(float(value) + 0.5) / 2 - 0.5}\n"
            file.write(line)
    return out


def tasks(folder, names, most_frames):
    """@return [(name, options, derive or None)]; derive(out) writes the folder"""
    frames, truth = read_frames(folder), read_truth(folder)
    limited = frames[:most_frames]
    limit = ["--frames", str(most_frames)] if most_frames else []
    todo = [("base", limit, None)]
    if "starts" in names:
        for index in range(1, STARTS):
            first = int(index * STARTS_WITHIN * len(frames) / STARTS)
            todo.append((f"start {first}", ["--start", str(first), *limit], None))
    for name, (retime, change) in VARIATIONS.items():
        if name in names:
            todo.append((name, [], lambda out, r=retime, c=change: write_folder(folder, *r(limited, truth), out, c)))
    return todo


HEADER = (f"{'':14}{'posed %':>9}{'ATE mm':>9}{'of base':>9}{'worst mm':>10}{'RPE mm/s':>10}{'precision':>11}"
          f"{'recall':>8}")


def row(name, result, base):
    def cell(value, form, width, scale=1.0):
        return f"{'-':>{width}}" if value is None else f"{scale * value:{width}{form}}"
    ratio = result["ate_rmse_m"] / base["ate_rmse_m"]
    marks = (" *" if ratio > MOST_OF_BASE else "") + (" !" if result["ate_worst_m"] > MOST_OK_ERROR_M else "")
    return (f"{name:14}" + cell(result["posed"] / result["frames"], ".1f", 9, 100) + cell(result["ate_rmse_m"], ".1f", 9, 1e3)
            + cell(ratio, ".2f", 9) + cell(result["ate_worst_m"], ".1f", 10, 1e3) + cell(result["rpe_rmse_m"], ".1f", 10, 1e3)
            + cell(result["mask_precision"], ".3f", 11) + cell(result["mask_recall"], ".3f", 8) + marks)


def variations(run_once, folder, camera, options, names, most_frames, out_dir, say):
    """@param run_once  (folder, camera, out, options) -> numbers  @param names  of NAMES
    @return {variation: numbers}, text"""
    results, lines = {}, [HEADER]
    for name, more, derive in tasks(folder, names, most_frames):
        say(name)
        run_dir = os.path.join(out_dir, name.replace(" ", "_"))
        os.makedirs(run_dir, exist_ok=True)
        with tempfile.TemporaryDirectory() as derived:
            if derive is not None:
                derive(derived)
            used = half_camera(camera, os.path.join(derived, "camera.yaml")) if name == "320x240" else camera
            results[name] = run_once(derived if derive else folder, used, run_dir, (*options, *more))
        lines.append(row(name, results[name], results["base"]))
    lines.append(f"* worse than {MOST_OF_BASE:g} times the base; ! a frame with a pose is off by more than "
                 f"{1e3 * MOST_OK_ERROR_M:.0f} mm")
    return results, "\n".join(lines)

#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The semantic_vslam authors
# SPDX-License-Identifier: BSD-3-Clause
"""Plays a recording through the nodelets at real time and shows what comes out; behind `./run demo`.

Leaves in out/demo/: trajectory.txt, groundtruth.txt, the map (cloud.pcd, mesh.ply, map.ot, map.bt, grid.pgm
and grid.yaml, map.dense), trajectory.png, rviz.png, figures.json, log/.
"""
import argparse
import json
import math
import os
import shutil
import signal
import socket
import statistics
import subprocess
import sys
import time

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
CAMERA_TOPICS = ("/camera/rgb/image_color", "/camera/depth/image", "/camera/rgb/camera_info")
WIDTH, HEIGHT = 1280, 900  # of the rviz window, as in rviz/semantic_vslam.rviz


class DemoError(Exception):
    """What went wrong and what to do, in one line."""


def say(text):
    print("[demo] " + text, flush=True)


class Processes:
    """Child processes with a log file each; all of them end with this one."""

    def __init__(self, log_dir, environment):
        self.log_dir = log_dir
        self.environment = environment
        self.running = []  # (name, process)
        os.makedirs(log_dir, exist_ok=True)

    def log_path(self, name):
        return os.path.join(self.log_dir, name + ".log")

    def start(self, name, command, **environment):
        with open(self.log_path(name), "w") as log:
            process = subprocess.Popen(command, stdout=log, stderr=subprocess.STDOUT, start_new_session=True,
                                       env={**self.environment, **environment})
        self.running.append((name, process))
        return process

    def run(self, name, command, timeout_s):
        """Runs to the end; returns its output. Fails with the last line that it wrote."""
        process = self.start(name, command)
        try:
            status = process.wait(timeout_s)
        except subprocess.TimeoutExpired:
            raise DemoError(f"{name} took longer than {timeout_s} s; its log is {self.log_path(name)}")
        self.running.remove((name, process))
        with open(self.log_path(name)) as log:
            output = log.read()
        if status != 0:
            raise DemoError(f"{name}: {last_line(output)} (log: {self.log_path(name)})")
        return output

    def check(self):
        """Fails if one of them ended by itself."""
        for name, process in self.running:
            if process.poll() is not None:
                with open(self.log_path(name)) as log:
                    raise DemoError(f"{name} ended early: {last_line(log.read())} (log: {self.log_path(name)})")

    def stop(self, name, patience_s=15):
        for entry in [entry for entry in self.running if entry[0] == name]:
            self.running.remove(entry)
            end(entry[1], patience_s)

    def stop_all(self):
        for _, process in reversed(self.running):
            end(process)
        self.running = []


def end(process, patience_s=15):
    """Ends a process and its children: politely, then for good."""
    for number, wait_s in ((signal.SIGINT, patience_s), (signal.SIGTERM, 5), (signal.SIGKILL, 5)):
        try:
            os.killpg(process.pid, number)
            process.wait(wait_s)
        except subprocess.TimeoutExpired:
            continue
        except ProcessLookupError:
            return


def last_line(text):
    lines = [line.strip() for line in text.splitlines() if line.strip()]
    # The reason is in the first error, if one is marked; the launcher's own last words come long after it.
    marked = [line for line in lines if any(word in line for word in ("[FATAL]", "FATAL", "[ERROR]", "error:"))]
    return (marked or lines or ["no output"])[0 if marked else -1]


def free_port():
    with socket.socket() as probe:
        probe.bind(("localhost", 0))
        return probe.getsockname()[1]


def package_program(name):
    for folder in os.environ.get("CMAKE_PREFIX_PATH", "").split(":"):
        path = os.path.join(folder, "lib", "semantic_vslam", name)
        if os.access(path, os.X_OK):
            return path
    raise DemoError(f"program {name} is not built; run ./run build")


def require(*programs):
    missing = [program for program in programs if shutil.which(program) is None]
    if missing:
        raise DemoError("not installed: " + ", ".join(missing) + "; scripts/install_dependencies.sh demo installs them")


def make_bag(options, processes):
    """The recording to play: the given one, a converted TUM folder, or a rendered room."""
    if options.bag:
        if not os.path.isfile(options.bag):
            raise DemoError(f"bag '{options.bag}' does not exist")
        return os.path.abspath(options.bag)
    bags = os.path.join(ROOT, "out", "bags")
    os.makedirs(bags, exist_ok=True)
    if options.sequence:
        bag = os.path.join(bags, os.path.basename(os.path.abspath(options.sequence)) + ".bag")
        say(f"converting {options.sequence}")
        command = [package_program("tum_to_bag"), options.sequence, bag, "--mask"]
        processes.run("tum_to_bag", command + (["--camera", options.camera] if options.camera else []), 900)
        return bag
    bag, renderer = os.path.join(bags, "synthetic.bag"), package_program("make_synthetic_bag")
    if not os.path.isfile(bag) or os.path.getmtime(bag) < os.path.getmtime(renderer):
        say("rendering a room with walking people (once, about a minute)")
        processes.run("make_synthetic_bag", [renderer, "--out", bag, "--lz4", "--seconds", "12"], 900)
    return bag


class Recording:
    """What the bag says of itself."""

    def __init__(self, path):
        import rosbag
        try:
            with rosbag.Bag(path) as bag:
                self.start_s, self.end_s = bag.get_start_time(), bag.get_end_time()
                self.topics = bag.get_type_and_topic_info().topics
                self.truth = list(true_poses(bag, self.topics))
        except (rosbag.ROSBagException, OSError, ValueError) as error:
            raise DemoError(f"bag '{path}' cannot be read: {error}; record or convert it again")
        for topic in CAMERA_TOPICS[:2]:
            if topic not in self.topics:
                raise DemoError(f"bag '{path}' has no topic {topic}; it holds {', '.join(sorted(self.topics))}")
        self.frames = self.topics["/camera/rgb/image_color"].message_count

    @property
    def duration_s(self):
        return self.end_s - self.start_s


def true_poses(bag, topics):
    """(stamp, [x y z qx qy qz qw]) of the optical frame in the world: as a topic, or the chain of transforms that the
    benchmark's bags have."""
    if "/groundtruth/pose" in topics:
        for _, message, _ in bag.read_messages(topics=["/groundtruth/pose"]):
            p, q = message.pose.position, message.pose.orientation
            yield message.header.stamp, [p.x, p.y, p.z, q.x, q.y, q.z, q.w]
    elif "/tf" in topics:
        for _, message, _ in bag.read_messages(topics=["/tf"]):
            yield from pose_of_chain(message.transforms)


def pose_of_chain(transforms):
    import numpy
    from tf import transformations
    edges = {edge.child_frame_id.lstrip("/"): edge for edge in transforms}
    pose, frame = numpy.eye(4), "openni_rgb_optical_frame"
    while frame in edges:
        edge = edges[frame]
        t, q = edge.transform.translation, edge.transform.rotation
        parent = transformations.quaternion_matrix([q.x, q.y, q.z, q.w])
        parent[:3, 3] = [t.x, t.y, t.z]
        pose, frame = parent @ pose, edge.header.frame_id.lstrip("/")
    if frame == "world":
        yield edge.header.stamp, list(pose[:3, 3]) + list(transformations.quaternion_from_matrix(pose))


def initial_pose(truth):
    """Height and tilt of the first true pose, so that the map is level; where it lies in the room is left open."""
    if not truth:
        return "{}"
    from tf import transformations
    values = truth[0][1]
    optical_in_body = transformations.euler_matrix(-math.pi / 2, 0, -math.pi / 2)
    body = transformations.quaternion_matrix(values[3:]) @ optical_in_body.T
    roll, pitch, _ = transformations.euler_from_matrix(body)
    return f"{{z: {values[2]:.4f}, roll: {roll:.4f}, pitch: {pitch:.4f}}}"


def write_trajectory(path, poses):
    with open(path, "w") as file:
        for stamp, values in poses:
            file.write(f"{stamp.secs}.{stamp.nsecs:09d} " + " ".join(f"{value:.9g}" for value in values) + "\n")


class Observer:
    """Follows the run while the recording plays; light, so that it takes no time from what is shown."""

    def __init__(self):
        import rospy
        from semantic_vslam.msg import TrackingReport
        self.state = None
        self.state_names = {getattr(TrackingReport, name): name
                            for name in ("INITIALISING", "OK", "RECENTLY_LOST", "LOST", "WAITING", "PAUSED")}
        rospy.Subscriber("/tracking/state", TrackingReport, self.on_state, queue_size=1)

    def on_state(self, message):
        self.state = message

    def progress(self, recording):
        if not self.state:
            return "no frame tracked yet"
        played_s = self.state.header.stamp.to_sec() - recording.start_s
        return (f"{played_s:5.1f} of {recording.duration_s:.1f} s: {self.state_names[self.state.state]}, {self.state.inliers} inliers, {self.state.keyframes} keyframes, "
                f"{self.state.landmarks} landmarks")


class ResultsRecorder:
    """Records what the nodelets publish."""

    TOPICS = ("/tracking/state", "/tracking/pose", "/motion/report", "/motion/mask", "/tf", "/diagnostics")
    CLOSING_S = 60  # the recorder writes its backlog and the index first, slowly where other work takes the machine

    def __init__(self, processes):
        self.processes = processes
        self.path = os.path.join(processes.log_dir, "results.bag")
        for old in (self.path, self.path + ".active"):
            if os.path.exists(old):
                os.remove(old)
        # Not `rosbag record`, which starts the same program but ends a quarter of a second after SIGINT, whether that has closed
        # the bag or not. Without compression the masks are 9 MB/s to write.
        processes.start("rosbag_record", ["rosrun", "rosbag", "record", "--quiet", "--lz4", "-O", self.path, *self.TOPICS])

    def close(self):
        self.processes.stop("rosbag_record", self.CLOSING_S)
        if not os.path.isfile(self.path):
            raise DemoError(f"rosbag record did not finish {self.path} within {self.CLOSING_S} s: is the disk full, or "
                            f"the machine busy? Its log is {self.processes.log_path('rosbag_record')}")
        return self.path


class Results:
    """What the nodelets published, from the bag that was recorded of it."""

    def __init__(self, path):
        import rosbag
        self.states, self.motion_ms, self.tf_stamps, self.masks, self.diagnostics = [], [], [], {}, {}
        with rosbag.Bag(path) as bag:
            for topic, message, _ in bag.read_messages():
                if topic == "/tracking/state":
                    if message.state not in (message.WAITING, message.PAUSED):  # of a frame
                        self.states.append(message)
                elif topic == "/motion/report":
                    self.motion_ms.append(message.cpu_ms)
                elif topic == "/motion/mask":
                    self.masks[message.header.stamp.to_nsec()] = pixels(message) >= 128
                elif topic == "/tf":
                    self.tf_stamps += [edge.header.stamp.to_sec() for edge in message.transforms
                                       if edge.header.frame_id == "map"]
                elif topic == "/diagnostics":
                    for status in message.status:
                        values = {item.key: item.value for item in status.values}
                        self.diagnostics.setdefault(status.name.split(": ")[-1], []).append(values)

    def mask_iou(self, bag_path, topics):
        """Intersection over union of all moving pixels, over the frames that have both masks; None without any."""
        import numpy
        import rosbag
        if "/groundtruth/mask" not in topics:
            return None
        intersection = union = 0
        with rosbag.Bag(bag_path) as bag:
            for _, message, _ in bag.read_messages(topics=["/groundtruth/mask"]):
                mask, truth = self.masks.get(message.header.stamp.to_nsec()), pixels(message) >= 128
                if mask is not None:
                    intersection += numpy.count_nonzero(mask & truth)
                    union += numpy.count_nonzero(mask | truth)
        return intersection / union if union else None

    def stage_cpu_ms(self):
        times = {"tracking": [state.cpu_ms for state in self.states], "motion": self.motion_ms}
        for stage in ("segmentation", "mapping"):
            times[stage] = [float(values["cpu median"].split()[0]) for values in self.diagnostics.get(stage, [])
                            if "cpu median" in values]
        return {stage: statistics.median(values) for stage, values in times.items() if values}

    def newest(self, stage, key):
        reports = self.diagnostics.get(stage, [])
        return reports[-1].get(key) if reports else None

    def tf_hz(self):
        span_s = max(self.tf_stamps) - min(self.tf_stamps) if self.tf_stamps else 0.0
        return (len(self.tf_stamps) - 1) / span_s if span_s else 0.0


def pixels(message):
    import numpy
    return numpy.frombuffer(message.data, numpy.uint8).reshape(message.height, message.step)[:, :message.width]


def wait_until(condition, processes, timeout_s, what):
    deadline = time.monotonic() + timeout_s
    while not condition():
        processes.check()
        if time.monotonic() > deadline:
            raise DemoError(f"{what} did not happen within {timeout_s} s; the logs are in {processes.log_dir}")
        time.sleep(0.2)


def start_display(processes):
    """A screen for rviz where there is none. Returns its name."""
    for number in range(77, 177):
        if os.path.exists(f"/tmp/.X11-unix/X{number}") or os.path.exists(f"/tmp/.X{number}-lock"):
            continue
        display = f":{number}"
        process = processes.start("xvfb", ["Xvfb", display, "-screen", "0", f"{WIDTH}x{HEIGHT}x24", "+extension", "GLX"])
        time.sleep(1.0)
        if process.poll() is None:
            return display
        processes.stop("xvfb")
    raise DemoError("no X server could be started; see " + processes.log_path("xvfb"))


def call_service(name):
    import rospy
    from std_srvs.srv import Trigger
    try:
        answer = rospy.ServiceProxy(name, Trigger)()
    except rospy.ServiceException as error:
        raise DemoError(f"service {name} failed: {error}")
    if not answer.success:
        raise DemoError(f"service {name}: {answer.message}")
    return answer.message


def subscribers(topic):
    import rosgraph
    return dict(rosgraph.Master("/demo").getSystemState()[1]).get(topic, [])


def launch_slam(options, recording, processes, display):
    slam = ["roslaunch", "--wait", "semantic_vslam", "slam.launch", "rgb:=/camera/rgb/image_color",
            "depth:=/camera/depth/image", "info:=/camera/rgb/camera_info", "rectified:=false", "rviz:=true",
            "output:=" + options.out, "nodelets:=" + ("false" if options.nodes else "true"), "queue_size:=10",
            "initial_pose:=" + initial_pose(recording.truth)]
    for name, value in (("camera_file", options.camera), ("model", options.model), ("config", options.config)):
        if value:
            slam.append(f"{name}:={os.path.abspath(value)}")
    if options.model == "":
        slam.append("model:=")
    processes.start("slam", slam, DISPLAY=display, QT_X11_NO_MITSHM="1", LIBGL_ALWAYS_SOFTWARE="1")


def play(bag, recording, processes, observer):
    player = processes.start("rosbag_play", ["rosbag", "play", "--clock", "--quiet", bag, "--topics", *CAMERA_TOPICS])
    last_report = 0.0
    while player.poll() is None:
        time.sleep(0.1)
        if time.monotonic() - last_report > 2.0:
            last_report = time.monotonic()
            say(observer.progress(recording))
        for name, process in processes.running:
            if name != "rosbag_play" and process.poll() is not None:
                processes.check()
    if player.returncode != 0:
        processes.check()
    processes.stop("rosbag_play")


def take_picture(processes, display, path):
    processes.run("screenshot", ["import", "-display", display, "-window", "root", path], 60)


def evaluate(options, recording, processes):
    truth, estimate = os.path.join(options.out, "groundtruth.txt"), os.path.join(options.out, "trajectory.txt")
    if not recording.truth:
        return None
    write_trajectory(truth, recording.truth)
    command = [package_program("evaluate_trajectory"), truth, estimate, "--json",
               "--plot", os.path.join(options.out, "trajectory.png")]
    return json.loads(processes.run("evaluate_trajectory", command, 120))


def cloud_points(path):
    with open(path, "rb") as file:
        for line in file:
            if line.startswith(b"POINTS"):
                return int(line.split()[1])
    return 0


def figures(options, bag, recording, results, errors):
    cloud, octomap = os.path.join(options.out, "cloud.pcd"), os.path.join(options.out, "map.ot")
    posed = sum(1 for state in results.states if state.state in (state.OK, state.RECENTLY_LOST))
    return {
        "frames": recording.frames,
        "dropped": recording.frames - len(results.states),
        "posed": posed,
        "posed_share": posed / recording.frames,
        "tf_hz": results.tf_hz(),
        "frames_without_mask": sum(1 for state in results.states if not state.has_mask),
        "ate_rmse_m": errors["ate_m"]["rmse"] if errors else None,
        "rpe_rmse_m": errors["rpe_translation_m"]["rmse"] if errors else None,
        "rpe_rmse_deg": errors["rpe_rotation_deg"]["rmse"] if errors else None,
        "mask_iou": results.mask_iou(bag, recording.topics),
        "cpu_ms_median": results.stage_cpu_ms(),
        "cloud_points": cloud_points(cloud),
        "cloud_bytes": os.path.getsize(cloud),
        "octomap_bytes": os.path.getsize(octomap),
        "voxels": results.newest("mapping", "voxels"),
    }


def print_figures(result):
    def show(name, value):
        print(f"  {name:<34} {value}")

    missing = "not in this recording"
    print()
    if result["ate_rmse_m"] is None:
        show("trajectory error", missing)
    else:
        show("ATE RMSE", f"{result['ate_rmse_m']:.4f} m")
        show("RPE RMSE over 1 s", f"{result['rpe_rmse_m']:.4f} m, {result['rpe_rmse_deg']:.3f} deg")
    show("frames with a pose", f"{result['posed']} of {result['frames']} ({100 * result['posed_share']:.1f} %)")
    show("tf rate", f"{result['tf_hz']:.1f} Hz of the recording's time")
    show("frames tracked without mask", result["frames_without_mask"])
    show("mask IoU", missing if result["mask_iou"] is None else f"{result['mask_iou']:.3f}")
    for stage, value in result["cpu_ms_median"].items():
        show(f"CPU of {stage}, median", f"{value:.1f} ms a " + ("frame" if stage in ("tracking", "motion") else "keyframe"))
    show("cloud", f"{result['cloud_points']} points, {result['cloud_bytes'] / 1e6:.1f} MB")
    show("OctoMap", f"{result['octomap_bytes'] / 1e6:.2f} MB, {result['voxels']} known voxels")
    print()


def run(options, processes):
    import rospy
    require("Xvfb", "import", "roslaunch", "rosbag", "rosrun", "rviz")
    bag = make_bag(options, processes)
    recording = Recording(bag)
    say(f"{bag}: {recording.frames} frames, {recording.duration_s:.1f} s")

    display = start_display(processes)
    processes.start("roscore", ["roscore", "-p", os.environ["ROS_MASTER_URI"].rsplit(":", 1)[1]])
    wait_until(rosgraph_is_online, processes, 30, "the start of the ROS master")
    rospy.set_param("/use_sim_time", True)
    rospy.init_node("demo", anonymous=True, disable_signals=True)
    observer = Observer()
    say("starting the nodelets and rviz")
    recorder = ResultsRecorder(processes)
    launch_slam(options, recording, processes, display)
    wait_until(lambda: all(len(subscribers(topic)) >= (3 if options.nodes else 1) for topic in CAMERA_TOPICS[:2])
               and "/rviz" in subscribers("/mapping/semantic_cloud"), processes, 90, "the start of the nodelets and rviz")
    time.sleep(5.0)  # rviz has subscribed, but its software rendering needs a moment to draw the first time

    play(bag, recording, processes, observer)
    say("saving")
    time.sleep(3.0)  # the last keyframe on its way into the map, and that into rviz
    take_picture(processes, display, os.path.join(options.out, "rviz.png"))
    call_service("/slam_tracking/save_trajectory")
    call_service("/slam_mapping/save")
    time.sleep(1.2)  # one more round of diagnostics
    processes.stop("slam")
    results = Results(recorder.close())

    errors = evaluate(options, recording, processes)
    result = figures(options, bag, recording, results, errors)
    with open(os.path.join(options.out, "figures.json"), "w") as file:
        json.dump(result, file, indent=2)
    print_figures(result)
    if result["dropped"] > 0.05 * result["frames"]:
        say(f"{result['dropped']} frames were dropped, since this machine did not keep up: {os.cpu_count()} cores, load "
            f"{os.getloadavg()[0]:.1f}; end other work on it and run again")
    say(f"pictures, trajectory and maps: {options.out}")


def rosgraph_is_online():
    import rosgraph
    return rosgraph.is_master_online()


def main():
    parser = argparse.ArgumentParser(prog="./run demo", description=__doc__.splitlines()[0])
    source = parser.add_mutually_exclusive_group()
    source.add_argument("--sequence", metavar="DIR", help="TUM RGB-D folder to play")
    source.add_argument("--bag", metavar="FILE", help="bag with the topics of the TUM benchmark's")
    parser.add_argument("--camera", metavar="FILE", help="cfg/cameras/*.yaml in place of the recording's calibration")
    parser.add_argument("--model", metavar="FILE",
                        help="semantic network (.onnx), the package's own otherwise; '': motion alone")
    parser.add_argument("--config", metavar="FILE", default="", help="YAML with keys of any stage")
    parser.add_argument("--nodes", action="store_true", help="one process for each stage in place of nodelets")
    parser.add_argument("--out", metavar="DIR", default=os.path.join(ROOT, "out", "demo"))
    options = parser.parse_args()
    options.out = os.path.abspath(options.out)
    os.makedirs(options.out, exist_ok=True)

    os.environ["ROS_MASTER_URI"] = f"http://localhost:{free_port()}"
    os.environ.setdefault("ROS_HOSTNAME", "localhost")
    os.environ["ROS_LOG_DIR"] = os.path.join(options.out, "log", "ros")
    processes = Processes(os.path.join(options.out, "log"), dict(os.environ))
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))
    # A shell's background jobs ignore it, and so would what is started here, which it ends: rosbag record breaks off then.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        run(options, processes)
    except DemoError as error:
        print(f"[demo] FAILED: {error}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        print("[demo] stopped", file=sys.stderr)
        return 130
    finally:
        processes.stop_all()
    return 0


if __name__ == "__main__":
    sys.exit(main())

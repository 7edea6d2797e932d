# What a soak must reach: memory and open files of its processes, and the frames that were lost.
# SPDX-License-Identifier: BSD-3-Clause
"""A frame is lost if the camera did not show it, if it did not arrive, or if no torque answered it. The first shows in
the stamps, which are dt apart, the second in the sequence numbers that the publisher gives, the third in the torques."""
import collections
import os

import rosbag

from ddm_launch.run_folder import Trajectory, read_setting

# Of a node after a trial. time_s: since the first trial began.
Sample = collections.namedtuple("Sample", "run node trial time_s rss_kb open_files")
# One row of targets.csv; passed: 0 or 1.
Target = collections.namedtuple("Target", "run target measured passed")
FRAME_COLUMNS = ["run", "trial", "part", "due", "published", "recorded", "answered", "lost"]

GROWTH = 0.05  # of resident memory, since the first tenth of the trials: trial 30 of 300
IMAGES = 2.0  # that model_node may keep of each frame of a trial: one, and what else it needs


def reference_trial(last):
    """Where a node is warm: a tenth of all trials."""
    return max(1, last // 10)


def by_node(samples):
    """{node: its samples, in the order of the trials}."""
    nodes = {}
    for sample in sorted(samples, key=lambda sample: sample.trial):
        nodes.setdefault(sample.node, []).append(sample)
    return nodes


def after(samples, trial):
    """The first sample of a node that is not before the end of a trial."""
    return next(sample for sample in samples if sample.trial >= trial)


def memory_target(run, node, first, end, last, kept_bytes):
    """first, end: samples of the node. kept_bytes: of the images that it was given in between, or None if it keeps none."""
    name, passed = "resident memory of %s" % node, end.trial == last
    grown = end.rss_kb / first.rss_kb - 1.0
    measured = "%.1f MB after trial %d, %.1f MB after trial %d: %+.1f %%" % (
        first.rss_kb / 1024.0, first.trial, end.rss_kb / 1024.0, end.trial, 100.0 * grown)
    if kept_bytes is None:
        return Target(run, name, measured, int(passed and grown <= GROWTH))
    images = 1024.0 * (end.rss_kb - first.rss_kb) / max(1, kept_bytes)
    return Target(run, name, "%s, %.2f images a frame" % (measured, images), int(passed and images <= IMAGES))


def judge(run, last, samples, frames, image_bytes=None):
    """All targets of a run. last: number of its last trial; samples, frames: of this run; image_bytes: of an image, if those that
    model_node keeps may make it grow."""
    targets, tenth = [], reference_trial(last)
    for node, of_node in by_node(samples).items():
        first, end = after(of_node, tenth), of_node[-1]
        num_kept = sum(row["answered"] for row in frames if row["part"] == "trial" and first.trial < row["trial"] <= end.trial)
        kept_bytes = num_kept * image_bytes if image_bytes and node == "model_node" else None
        targets.append(memory_target(run, node, first, end, last, kept_bytes))
        # A bag or a connection may be open just then, now and then, so the most is a matter of luck; a leak raises the fewest.
        early = min(sample.open_files for sample in of_node if tenth <= sample.trial <= 2 * tenth)
        late = min(sample.open_files for sample in of_node if sample.trial >= last - tenth)
        targets.append(Target(run, "open files of %s" % node, "at least %d in trials %d to %d, %d in trials %d to %d" % (
            early, tenth, 2 * tenth, late, last - tenth, last), int(late <= early)))
    due = sum(max(row["due"], row["published"] or 0) for row in frames)
    lost = sum(row["lost"] for row in frames)
    return targets + [Target(run, "lost frames", "%d of %d" % (lost, due), int(bool(frames) and lost == 0))]


def frames_between(seconds, dt):
    """Number of frames from one to another, both counted."""
    return int(round(seconds / dt)) + 1


def count_recorded(images, torques, dt, num_steps):
    """images: (sequence number, stamp [ns]) of each, torques: stamps. Counts from the first to the last image that has
    a torque: in real time the camera also shows frames before and after a trial."""
    answered = [number for number, (_, stamp) in enumerate(images) if stamp in torques]
    if not answered:
        return {"due": num_steps, "published": 0, "recorded": 0, "answered": 0, "lost": num_steps}
    images = images[answered[0]:answered[-1] + 1]
    (first, start), (last, end) = images[0], images[-1]
    due = max(num_steps, frames_between(1e-9 * (end - start), dt))
    published = last - first + 1
    return {"due": due, "published": published, "recorded": len(images), "answered": len(answered),
            "lost": max(due, published) - len(answered)}


def count_seen(times, dt, num_steps):
    """Of an evaluation, which is not recorded. times: of the frames that were answered [s]."""
    due = max(num_steps, frames_between(times[-1] - times[0], dt))
    return {"due": due, "published": "", "recorded": "", "answered": len(times), "lost": due - len(times)}


def read_trial(path):
    """Images and torques of a bag, as count_recorded() wants them."""
    images, torques = [], set()
    with rosbag.Bag(path) as bag:
        for topic, message, _ in bag.read_messages(["camera/image_raw", "torque"]):
            stamp = message.header.stamp.to_nsec()
            if topic == "torque":
                torques.add(stamp)
            else:
                images.append((message.header.seq, stamp))
    return images, torques


def count_frames(run, folder, num_trials):
    """Rows of FRAME_COLUMNS, as dictionaries, about the first trials of a run folder and their evaluations."""
    dt = float(read_setting(folder, "plant", "dt", "time between two images"))
    num_steps = int(read_setting(folder, "trial", "num_steps", "frames of a trial"))
    rows = []
    for trial in range(num_trials):
        recorded = read_trial(os.path.join(folder, "trial_%03d" % trial, "trial.bag"))
        times = Trajectory(os.path.join(folder, "evaluation_%03d" % trial)).time_s
        for part, counts in (("trial", count_recorded(*recorded, dt, num_steps)),
                             ("evaluation", count_seen(times, dt, num_steps))):
            rows.append(dict(counts, run=run, trial=trial, part=part))
    return rows

# Which frames of a run the camera should have shown, and which of them have come to their torque.
# SPDX-License-Identifier: BSD-3-Clause
"""A frame is lost if the camera did not show it, if it did not arrive, or if no torque answered it. The first shows in
the stamps, which are dt apart, the second in the sequence numbers that the publisher gives, the third in the torques."""
import os

import rosbag

from ddm_launch.run_folder import Trajectory, read_setting

COLUMNS = ["run", "trial", "part", "due", "published", "recorded", "answered", "lost"]


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
    """Rows of COLUMNS, as dictionaries, about the first trials of a run folder and their evaluations."""
    dt = float(read_setting(folder, "plant", "dt", "time between two images"))
    num_steps = int(read_setting(folder, "trial", "num_steps", "frames of a trial"))
    rows = []
    for trial in range(num_trials):
        images, torques = read_trial(os.path.join(folder, "trial_%03d" % trial, "trial.bag"))
        rows.append(dict(count_recorded(images, torques, dt, num_steps), run=run, trial=trial, part="trial"))
        times = Trajectory(os.path.join(folder, "evaluation_%03d" % trial)).time_s
        rows.append(dict(count_seen(times, dt, num_steps), run=run, trial=trial, part="evaluation"))
    return rows

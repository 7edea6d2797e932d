# Images and torques of a run folder, as a program without our C++ reads them.
# SPDX-License-Identifier: BSD-3-Clause
import collections
import glob
import os

import numpy as np
import rosbag


class Trials(collections.namedtuple("Trials", "images torques begins")):
    """images: of all trials in [0, 1], then the goal  [N + 1 x D]. torques: [N x motors, N m]. begins: frames at which trials
    begin, and the end."""

    def targets(self, order):
        """Frames that have so many before them in their trial."""
        return np.concatenate([np.arange(begin + order, end) for begin, end in zip(self.begins, self.begins[1:])])


def read_trials(run, goal):
    """goal: grey values [D]."""
    images, torques, begins = [], [], [0]
    for path in sorted(glob.glob(os.path.join(run, "trial_*", "trial.bag"))):
        seen, acted = {}, {}
        with rosbag.Bag(path) as bag:
            for topic, message, _ in bag.read_messages():
                if topic.endswith("image_raw"):
                    seen[message.header.stamp] = np.frombuffer(message.data, np.uint8)
                elif topic.endswith("torque"):
                    acted[message.header.stamp] = message.torque
        stamps = sorted(set(seen) & set(acted))
        images += [seen[stamp] for stamp in stamps]
        torques += [acted[stamp] for stamp in stamps]
        begins.append(len(images))
    return Trials(np.array(images + [goal], dtype=np.float32) / 255, np.array(torques, dtype=np.float32), begins)

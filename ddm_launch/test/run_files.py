# Reads the files of an experiment for the tests.
# SPDX-License-Identifier: BSD-3-Clause
import rosbag

import rooms  # noqa: F401
from ddm_launch.run_folder import read_yaml  # noqa: F401
from ddm_qa.run_comparison import COLUMNS, differences, expected_files, files_in, read_bytes, read_rows  # noqa: F401


def changes(before, after):
    """Names of the files that differ between two snapshots."""
    return sorted(name for name in set(before) | set(after) if before.get(name) != after.get(name))


def torque_files(num_trials):
    return ["%s_%03d/torques.csv" % (kind, k) for k in range(num_trials + 1) for kind in ("trial", "evaluation")]


def read_bag(path):
    """Returns {topic: list of header stamps [ns]}."""
    stamps = {}
    with rosbag.Bag(path) as bag:
        for topic, message, _ in bag.read_messages():
            stamps.setdefault(topic, []).append(message.header.stamp.to_nsec())
    return stamps

# Reads the files of an experiment for the tests.
# SPDX-License-Identifier: BSD-3-Clause
import os

import rosbag

import rooms  # noqa: F401
from ddm_launch.run_folder import read_yaml  # noqa: F401
from ddm_qa.run_comparison import COLUMNS, differences, expected_files, files_in, read_bytes, read_rows  # noqa: F401


def fingerprint(folder):
    """Returns {path: (size, modification time [ns], bytes)} of all files and folders in a folder. Two fingerprints
    are equal if nothing was written in between. The lock file of a process is ignored."""
    paths = [os.path.join(parent, name) for parent, folders, files in os.walk(folder)
             for name in folders + files]
    found = {}
    for path in paths:
        status = os.lstat(path)
        found[path] = (status.st_size, status.st_mtime_ns, read_bytes(path) if os.path.isfile(path) else None)
    return found


def changes(before, after):
    """Paths that differ between two fingerprints."""
    return sorted(path for path in set(before) | set(after) if before.get(path) != after.get(path))


def torque_files(num_trials):
    return ["%s_%03d/torques.csv" % (kind, k) for k in range(num_trials + 1) for kind in ("trial", "evaluation")]


def read_bag(path):
    """Returns {topic: list of header stamps [ns]}."""
    stamps = {}
    with rosbag.Bag(path) as bag:
        for topic, message, _ in bag.read_messages():
            stamps.setdefault(topic, []).append(message.header.stamp.to_nsec())
    return stamps

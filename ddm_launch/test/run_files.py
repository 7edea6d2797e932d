# What the tests look at in the folder of an experiment.
# SPDX-License-Identifier: BSD-3-Clause
import rosbag

from ddm_launch.run_comparison import (COLUMNS, TIME_COLUMNS, comparable, differences, expected_files,  # noqa: F401
                                       files_in, read_bytes, read_rows, read_yaml)


def torque_files(num_trials):
    return ["%s_%03d/torques.csv" % (kind, k) for k in range(num_trials + 1) for kind in ("trial", "evaluation")]


def read_bag(path):
    """{topic: list of header stamps [ns]}."""
    stamps = {}
    with rosbag.Bag(path) as bag:
        for topic, message, _ in bag.read_messages():
            stamps.setdefault(topic, []).append(message.header.stamp.to_nsec())
    return stamps

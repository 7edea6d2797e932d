#!/usr/bin/python3
# Preset `paper`: the nodes and run_experiment give the same, torque by torque.
# SPDX-License-Identifier: BSD-3-Clause
import os
import sys

import rosunit

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from both_drivers_case import BothDriversCase  # noqa: E402
from run_files import read_rows, torque_files  # noqa: E402

TRIALS = 3


class RosEqualsProcessTest(BothDriversCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.runBothDrivers(4, TRIALS, {"preset": "paper", "plant": "pendulum"})

    def test_all_files_are_equal_and_no_torque_is_missing(self):
        self.assertAllFilesAreEqual()
        names = torque_files(TRIALS)
        self.assertEqual(len(names), 8)
        for name in names:
            self.assertEqual(len(read_rows(self.nodes, name)), 1 + 100)


if __name__ == "__main__":
    rosunit.unitrun("ddm_launch", "ros_equals_process_test", RosEqualsProcessTest)

#!/usr/bin/python3
# Preset `paper`: the nodes and run_experiment give the same, torque by torque.
# SPDX-License-Identifier: BSD-3-Clause
import os
import sys

import rosunit

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from both_drivers_case import BothDriversCase  # noqa: E402
from run_files import expected_files, read_rows, torque_files  # noqa: E402

TRIALS = 3


class RosEqualsProcessTest(BothDriversCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.runBothDrivers(4, TRIALS, {"preset": "paper", "plant": "pendulum"})

    def test_torques_are_equal_byte_by_byte(self):
        names = torque_files(TRIALS)
        self.assertEqual(len(names), 8)
        self.assertEqualFiles(names)
        for name in names:
            self.assertEqual(len(read_rows(self.nodes, name)), 1 + 100)

    def test_models_are_equal_byte_by_byte(self):
        self.assertEqualFiles([name for name in expected_files(TRIALS) if name.endswith("model.ddm")])

    def test_trajectories_and_results_are_equal(self):
        names = [name for name in expected_files(TRIALS) if name.endswith("trajectory.csv")]
        self.assertEqualFiles(names + ["trials.csv", "summary.yaml"])

    def test_configurations_are_equal_but_for_the_folder(self):
        self.assertEqualFiles(["config.yaml"])


if __name__ == "__main__":
    rosunit.unitrun("ddm_launch", "ros_equals_process_test", RosEqualsProcessTest)

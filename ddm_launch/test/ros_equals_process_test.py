#!/usr/bin/python3
# Preset `paper`: the nodes and run_experiment give the same, torque by torque.
# SPDX-License-Identifier: BSD-3-Clause
import os
import shutil
import sys
import tempfile
import unittest

import rosunit

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from processes import run_both_drivers  # noqa: E402
from run_files import differences, expected_files, read_rows, torque_files  # noqa: E402

TRIALS = 3


class RosEqualsProcessTest(unittest.TestCase):
    maxDiff = None

    @classmethod
    def setUpClass(cls):
        cls.scratch = tempfile.mkdtemp()
        folders, outputs = run_both_drivers(cls.scratch, 4, TRIALS, {"preset": "paper", "plant": "pendulum"})
        (cls.nodes, cls.process), (cls.nodes_output, cls.process_output) = folders, outputs

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.scratch)

    def assertEqualFiles(self, names):
        self.assertTrue(os.path.exists(os.path.join(self.nodes, "summary.yaml")), self.nodes_output)
        self.assertTrue(os.path.exists(os.path.join(self.process, "summary.yaml")), self.process_output)
        self.assertEqual(differences(self.nodes, self.process, names), [])

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

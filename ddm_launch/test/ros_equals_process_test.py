# Preset `paper`: the nodes and run_experiment give the same, torque by torque.
# SPDX-License-Identifier: BSD-3-Clause
from both_drivers_case import BothDriversCase
from run_files import read_rows, torque_files

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

#!/usr/bin/python3
# Instructions of one objective with its gradient and of one plan, counted by callgrind: a bound that no noise moves.
# SPDX-License-Identifier: BSD-3-Clause
import os
import re
import subprocess
import sys
import tempfile
import unittest

import rosunit

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from processes import find_program  # noqa: E402

# What was counted with GCC 12 and Eigen 3.4 for plain x86-64, and some more for other versions of both.
COUNTED = {"objective": 41.1e6, "plan": 1.13e6}
SLACK = 1.15


class InstructionCountTest(unittest.TestCase):
    def instructions(self, what, count):
        """Of a whole run with so many calls."""
        with tempfile.TemporaryDirectory() as scratch:
            done = subprocess.run(["valgrind", "--tool=callgrind", "--callgrind-out-file=" +
                                   os.path.join(scratch, "callgrind.out"), find_program("ddm_launch", "instruction_probe"),
                                   what, str(count)],
                                  stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True)
        self.assertEqual(done.returncode, 0, done.stdout)
        return int(re.search(r"Collected : (\d+)", done.stdout).group(1))

    def assertBounded(self, what):
        """One call is the difference of two runs: what the program does besides drops out."""
        one_call = self.instructions(what, 3) - self.instructions(what, 2)
        print("%s: %d instructions" % (what, one_call))
        self.assertGreater(one_call, 0.5 * COUNTED[what], "far less than is possible: does the probe still work?")
        self.assertLess(one_call, SLACK * COUNTED[what])

    def test_an_objective_with_its_gradient_stays_within_its_bound(self):
        self.assertBounded("objective")

    def test_a_plan_stays_within_its_bound(self):
        self.assertBounded("plan")


if __name__ == "__main__":
    rosunit.unitrun("ddm_launch", "instruction_count", InstructionCountTest)

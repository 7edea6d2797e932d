#!/usr/bin/python3
# compare_results: equal rows, other rows, rows that are missing, and folders that it cannot compare.
# SPDX-License-Identifier: BSD-3-Clause
import os
import sys

import rosunit

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import rooms  # noqa: E402, F401
from ddm_study import compare_results  # noqa: E402
from processes import call_main  # noqa: E402
from scratch_case import ScratchCase  # noqa: E402

HEADER = "seed,trial,v_r,train_s,version\n"


class CompareResultsTest(ScratchCase):
    def setUp(self):
        super().setUp()
        self.write("old/trials.csv", HEADER + "300,0,1.5,0.1,1.0.0\n300,1,2.5,0.1,1.0.0\n301,0,3.5,0.1,1.0.0\n")
        self.write("old/machine.yaml", "steps: {joint: {cpu: One}}")
        self.write("old/success_rate.csv", "frames,success\n100,0.5\n")  # of all seeds
        self.write("new/trials.csv", HEADER + "300,0,1.5,0.2,1.0.1\n300,1,2.5,0.2,1.0.1\n")
        self.write("new/success_rate.csv", "frames,success\n100,1\n")
        self.write("new/runs/trials.csv", "seed\n7\n")

    def call(self, again="new"):
        return call_main(compare_results.main, [self.file("old"), self.file(again)])

    def test_rows_of_the_seeds_made_again_are_equal_but_for_times_and_versions(self):
        code, output = self.call()
        self.assertEqual((code, output.strip()), (0, "equal    trials.csv: 2 rows"))

    def test_the_first_number_that_differs_is_named_and_whether_the_processor_is_another(self):
        self.write("new/trials.csv", HEADER + "300,0,1.5,0.2,1.0.1\n300,1,2.25,0.2,1.0.1\n")
        self.write("new/machine.yaml", "steps: {joint: {cpu: Two}}")
        code, output = self.call()
        self.assertEqual(code, 1)
        for part in ("differs  trials.csv", "row 2, seed 300: v_r is 2.5 in the committed file, and 2.25", "1 of 1 tables",
                     "not made on Two"):
            self.assertIn(part, output)

    def test_rows_that_are_missing_are_a_difference(self):
        self.write("new/trials.csv", HEADER + "300,0,1.5,0.2,1.0.1\n")
        code, output = self.call()
        self.assertEqual(code, 1)
        self.assertIn("2 rows of these seeds are committed, and 1 were made", output)

    def test_folders_without_a_common_table_are_refused(self):
        os.remove(self.file("new/trials.csv"))
        self.assertIn("has no table of seeds", self.call()[1])
        code, output = self.call("nowhere")
        self.assertEqual(code, 1)
        self.assertIn("nowhere is no folder", output)


if __name__ == "__main__":
    rosunit.unitrun("ddm_launch", "compare_results_test", CompareResultsTest)

# compare_results: equal rows, other rows, rows that are missing, and folders that it cannot compare.
# SPDX-License-Identifier: BSD-3-Clause
import os

from ddm_study import compare_results
from processes import call_main
from scratch_case import ScratchCase

HEADER = "seed,trial,v_r,train_s,version\n"


class CompareResultsTest(ScratchCase):
    def setUp(self):
        super().setUp()
        self.write("old/trials.csv", HEADER + "300,0,1.5,0.1,1.0.0\n300,1,2.5,0.1,1.0.0\n301,0,3.5,0.1,1.0.0\n")
        self.write("old/machine.yaml", "steps: {joint: {cpu: One}}")
        self.write("old/success_rate.csv", "frames,success\n100,0.5\n")  # of all seeds
        self.write("new/trials.csv", HEADER + "300,0,1.5,0.2,1.0.1\n300,1,2.5,0.2,1.0.1\n")
        self.write("new/success_rate.csv", "frames,success\n100,1\n")

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

    def test_a_column_of_one_table_alone_is_a_difference(self):
        self.write("old/trials.csv", "seed,trial,final_error\n300,0,2.5\n")
        self.write("new/trials.csv", "seed,trial,final_error,v_q\n300,0,2.5,1\n")
        code, output = self.call()
        self.assertEqual(code, 1)
        self.assertIn("columns v_q", output)

    def test_returns_are_compared_where_both_have_them(self):
        self.write("old/trials.csv", "seed,trial,return\n300,0,700\n")
        self.write("new/trials.csv", "seed,trial,return\n300,0,701\n")
        self.assertIn("return is 700 in the committed file, and 701", self.call()[1])

    def test_a_table_of_times_alone_is_not_called_equal(self):
        self.write("old/times.csv", "seed,train_s,wall_s\n300,1,2\n")
        self.write("new/times.csv", "seed,train_s,wall_s\n300,3,4\n")
        self.assertNotIn("times.csv", self.call()[1])

    def test_folders_without_a_common_table_are_refused(self):
        os.remove(self.file("new/trials.csv"))
        self.assertIn("has no table of seeds", self.call()[1])
        code, output = self.call("nowhere")
        self.assertEqual(code, 1)
        self.assertIn("there is no folder " + self.file("nowhere"), output)

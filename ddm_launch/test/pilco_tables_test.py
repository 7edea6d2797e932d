# Tables of PILCO: counts, times and verdicts of made-up results.
# SPDX-License-Identifier: BSD-3-Clause
import os

from ddm_launch import success_rate
from ddm_launch.command import Failure
from ddm_study import pilco_tables
from scratch_case import ScratchCase
import synthetic_run

FIRST = "PILCO, state: successes of policy 1"
LATER = "PILCO, state: successes of policy 2 to 6"
TIME = "PILCO, state: time to policy 10, largest of 12 seeds"


class PilcoTablesTest(ScratchCase):
    def setUp(self):
        super().setUp()
        self.writeResults("pilco_state")

    def writeResults(self, name, seeds=12, trials=12, success=lambda seed, trial: True,
                     train_s=lambda seed, trial: 60.0):
        """Results of one method. The Gaussian process takes a quarter of the training."""
        folder = self.file(name)
        os.makedirs(folder, exist_ok=True)
        with open(os.path.join(folder, "trials.csv"), "w") as table, \
                open(os.path.join(folder, "policy_search.csv"), "w") as searches:
            table.write(synthetic_run.TRIAL_COLUMNS + "\n")
            searches.write("seed,trial,frames,gp_s,policy_search_s\n")
            for seed in range(seeds):
                for k in range(trials):
                    seconds = train_s(seed, k)
                    table.write(synthetic_run.pilco_row(seed, k, success(seed, k), seconds) + "\n")
                    searches.write("%d,%d,%d,%g,%g\n" % (seed, k, 125 * (k + 1), 0.25 * seconds, 0.75 * seconds))

    def success(self, *names):
        return {(row[0], row[1]): row[2:] for row in pilco_tables.success_rows(self.scratch, names or ["pilco_state"])}

    def times(self, name):
        return {(row[0], row[1]): row[2:5] for row in pilco_tables.time_rows(self.scratch, [name])}

    def agreement(self, *names):
        return {row[0]: row[1:] for row in pilco_tables.agreement_rows(self.scratch, names or ["pilco_state"])}

    def test_each_policy_is_counted_over_the_seeds_and_beside_the_authors(self):
        self.writeResults("pilco_state", success=lambda seed, trial: seed >= trial)
        rows = self.success()
        self.assertEqual(rows["pilco_state", "1"], ("125", 12, 12, 11, 12))
        self.assertEqual(rows["pilco_state", "4"], ("500", 9, 12, 12, 12))
        self.assertEqual(rows["pilco_state", "12"], ("1500", 1, 12, 11, 12))
        self.assertEqual(rows["pilco_state", "2 to 6"], ("250 to 750", 11 + 10 + 9 + 8 + 7, 60, 60, 60))
        self.assertEqual(len(rows), 13)

    def test_methods_that_do_not_see_the_state_stand_without_the_authors_runs(self):
        self.writeResults("pilco_features", seeds=5, trials=16, success=lambda seed, trial: trial == 15)
        self.writeResults("pilco_pca", seeds=1, trials=5)
        rows = self.success("pilco_features", "pilco_pca")
        self.assertEqual(rows["pilco_features", "16"], ("2000", 5, 5, "", ""))
        self.assertEqual(rows["pilco_pca", "5"], ("625", 1, 1, "", ""))
        self.assertNotIn(("pilco_pca", "2 to 6"), rows)  # it has five

    def test_times_are_median_and_largest_over_the_seeds(self):
        self.writeResults("pilco_state", train_s=lambda seed, trial: (seed + 1.0) * (trial + 1.0))
        rows = self.times("pilco_state")
        self.assertEqual(rows["PILCO, state: training", 125], (6.5, 12.0, "s"))
        self.assertEqual(rows["PILCO, state: training", 1250], (65.0, 120.0, "s"))
        self.assertEqual(rows["PILCO, state: of it Gaussian process", 1250], (16.25, 30.0, "s"))
        self.assertEqual(rows["PILCO, state: of it policy search", 125], (4.875, 9.0, "s"))
        median, largest, unit = rows["PILCO, state: training of the first 10 policies", 1250]
        self.assertAlmostEqual(median, 6.5 * 55.0 / 60.0)
        self.assertAlmostEqual(largest, 12.0 * 55.0 / 60.0)
        self.assertEqual(unit, "min")
        self.assertEqual(rows["PILCO, state: control, median of a greedy run", "all"], (0.01, 0.01, "ms"))
        self.assertEqual(rows["PILCO on the state, policies 2 to 10 of the authors", 1250], (3.75, 10.5, "h"))

    def test_a_seed_that_lacks_a_trial_is_named(self):
        path = self.file("pilco_state", "trials.csv")
        with open(path) as stream:
            lines = [line for line in stream if not line.startswith("3,11,")]
        with open(path, "w") as stream:
            stream.writelines(lines)
        with self.assertRaisesRegex(Failure, "pilco_state/trials.csv.*seed 3.* 11"):
            pilco_tables.time_rows(self.scratch, ["pilco_state"])

    def test_ten_of_twelve_first_policies_are_enough(self):
        for failures, holds in ((2, True), (3, False)):
            self.writeResults("pilco_state", success=lambda seed, trial: trial > 0 or seed >= failures)
            here = "%d of 12" % (12 - failures)
            self.assertEqual(self.agreement()[FIRST], (">= 10 of 12 (authors: 11)", here, holds))
            self.assertTrue(self.agreement()[LATER][2])

    def test_the_slowest_seed_must_reach_the_tenth_policy_in_half_an_hour(self):
        # The eleventh and twelfth policy do not count.
        for slowest_s, text, holds in ((179.9, "30.0 min", True), (182.0, "30.3 min", False)):
            self.writeResults("pilco_state", train_s=lambda seed, trial: 60.0 if seed else slowest_s)
            self.assertEqual(self.agreement()[TIME], ("< 30 min (authors: 3 to 10 h)", text + " (median 10.0)", holds))

    def test_what_has_no_target_is_reported_without_a_verdict(self):
        self.writeResults("pilco_state_sparse")
        self.writeResults("pilco_features", seeds=5, trials=16, success=lambda seed, trial: (seed, trial) == (1, 15))
        rows = self.agreement("pilco_state", "pilco_state_sparse", "pilco_features")
        self.assertEqual(rows["PILCO, features: successes of all policies"], ("reported (paper: 0)", "1 of 80", None))
        self.assertEqual(rows["PILCO, state, sparse GP: successes of all policies"], ("reported", "144 of 144", None))
        self.assertEqual(rows["PILCO, state, sparse GP: time to policy 10, largest of 12 seeds"],
                         ("reported", "10.0 min (median 10.0)", None))
        self.assertEqual(len(rows), 7)

# Means over experiments: standard errors, Wilson's intervals against published ones, and tests by hand.
# SPDX-License-Identifier: BSD-3-Clause
import unittest

from ddm_launch.averages import holm, mean_and_error, sign_test, success_rates, wilson_interval
from ddm_launch.run_folder import Trial


def trial(frames, success, strict):
    return Trial(0, frames, success, strict, None)


class AveragesTest(unittest.TestCase):
    def test_wilsons_intervals_are_those_of_newcombes_table(self):
        # R. G. Newcombe, "Two-sided confidence intervals for the single proportion", Stat. Med. 17 (1998), Table I.
        for successes, n, low, high in ((81, 263, 0.2553, 0.3662), (15, 148, 0.0624, 0.1605), (0, 20, 0.0, 0.1611),
                                        (1, 29, 0.0061, 0.1718)):
            interval = wilson_interval(successes / n, n)
            self.assertAlmostEqual(interval[0], low, delta=5e-5)
            self.assertAlmostEqual(interval[1], high, delta=5e-5)

    def test_an_interval_mirrors_that_of_the_failures_and_stays_within_0_and_1(self):
        low, high = wilson_interval(1.0, 20)
        self.assertAlmostEqual(low, 1.0 - 0.1611, delta=5e-5)
        self.assertEqual(high, 1.0)
        self.assertEqual(wilson_interval(0.0, 3)[0], 0.0)

    def test_more_confidence_is_a_wider_interval(self):
        narrow, wide = wilson_interval(0.9, 50), wilson_interval(0.9, 50, confidence=0.99)
        self.assertLess(wide[0], narrow[0])
        self.assertGreater(wide[1], narrow[1])

    def test_both_measures_of_success_have_a_rate_of_their_own(self):
        runs = [[trial(100, True, False), trial(200, True, True)], [trial(100, True, True), trial(200, None, None)]]
        self.assertEqual(success_rates(runs), [(100, 1.0, 0.0, 2), (200, 1.0, 0.0, 1)])
        self.assertEqual(success_rates(runs, "success_strict"), [(100, 0.5, 0.5, 2), (200, 1.0, 0.0, 1)])

    def test_the_error_of_a_mean_of_zeros_and_ones_is_that_of_a_rate(self):
        mean, error = mean_and_error([1.0, 0.0, 1.0, 1.0])
        self.assertEqual(mean, 0.75)
        self.assertAlmostEqual(error, (0.75 * 0.25 / 3.0) ** 0.5)

    def test_a_sign_test_counts_the_pairs_that_differ(self):
        # 0 or 1 of 5 fair coins: 1/32 and 6/32, both sides
        self.assertAlmostEqual(sign_test([-1.0, 0.0, -0.2, -1.0, -0.4, 0.0, -1.0]), 2.0 / 32.0)
        self.assertAlmostEqual(sign_test([1.0, -1.0, 1.0, 1.0, 1.0]), 12.0 / 32.0)
        self.assertEqual(sign_test([1.0, -1.0]), 1.0)  # 3/4 on each side
        self.assertEqual(sign_test([0.0, 0.0]), 1.0)

    def test_holm_multiplies_by_the_tests_that_are_left_and_keeps_their_order(self):
        for p, expected in zip(holm([0.04, 0.01, 0.03]), (0.06, 0.03, 0.06)):
            self.assertAlmostEqual(p, expected)
        self.assertEqual(holm([0.6, 0.5]), [1.0, 1.0])
        self.assertEqual(holm([]), [])

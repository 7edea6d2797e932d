# Means over experiments: standard errors, Wilson's intervals compared with published ones, and sign tests.
# SPDX-License-Identifier: BSD-3-Clause
import numpy as np
import pandas
import pytest

from ddm_launch.averages import holm, mean_and_error, sign_test, success_rates, wilson_interval


def test_wilsons_intervals_are_those_of_newcombes_table():
    # Source: R. G. Newcombe, "Two-sided confidence intervals for the single proportion", Stat. Med. 17 (1998), Table I.
    for successes, n, low, high in ((81, 263, 0.2553, 0.3662), (15, 148, 0.0624, 0.1605), (0, 20, 0.0, 0.1611),
                                    (1, 29, 0.0061, 0.1718), (20, 20, 1.0 - 0.1611, 1.0)):
        assert wilson_interval(successes / n, n) == pytest.approx((low, high), abs=5e-5)


def test_success_counts_where_it_is_known():
    trials = pandas.DataFrame({"frames": [100, 200, 100, 200], "success": [1, 1, 0, np.nan]})
    rates = success_rates(trials)
    assert rates[["rate", "se", "runs"]].values.tolist() == [[0.5, 0.5, 2], [1.0, 0.0, 1]]
    assert rates.low[100] + rates.high[100] == pytest.approx(1.0)
    assert rates.low[200] == pytest.approx(1.0 / (1.0 + 1.959964 ** 2))


def test_the_standard_error_is_that_of_a_sample():
    assert mean_and_error([1.0, 2.0, 6.0]) == pytest.approx((3.0, (14.0 / 2.0 / 3.0) ** 0.5))
    # standard error of a rate
    assert mean_and_error([1.0, 0.0, 1.0, 1.0])[1] == pytest.approx((0.75 * 0.25 / 3.0) ** 0.5)
    assert mean_and_error([4.0]) == (4.0, 0.0)


def test_a_sign_test_counts_the_pairs_that_differ():
    # 0 or 1 heads in 5 tosses of a coin have the probabilities 1/32 and 6/32; the test is two-sided.
    assert sign_test([-1.0, 0.0, -0.2, -1.0, -0.4, 0.0, -1.0]) == pytest.approx(2.0 / 32.0)
    assert sign_test([1.0, -1.0, 1.0, 1.0, 1.0]) == pytest.approx(12.0 / 32.0)
    assert sign_test([1.0, -1.0]) == sign_test([0.0, 0.0]) == 1.0


def test_holm_multiplies_by_the_tests_that_are_left_and_keeps_their_order():
    assert holm([0.04, 0.01, 0.03]) == pytest.approx([0.06, 0.03, 0.06])
    assert holm([0.6, 0.5]) == [1.0, 1.0]

# A short run of `qa benchmark`: nodes and kernels produce all values of its table.
# SPDX-License-Identifier: BSD-3-Clause
from unittest import mock

from ddm_qa import benchmark
from run_files import read_rows


def test_both_loops_and_all_parts_are_timed(tmp_path):
    # The nodes report their progress ten times a second. A loop of 1000 images can end before the second report.
    with mock.patch.multiple(benchmark, TRIALS=1, RESTARTS=1, RETRAININGS=2, NUM_FRAMES=10000):
        benchmark.work(str(tmp_path), "debug")
    rows = {name: (median, p99) for name, median, p99 in read_rows(tmp_path, "speed.csv")[1:]}
    assert all(float(rows[name][0]) > 0.0 for name in ("experiment", "lockstep_round_trip", "bare_round_trip"))
    for name in ("objective_gradient", "matrix_products", "retrain", "plan"):
        assert 0.0 < float(rows[name][0]) <= float(rows[name][1]), name

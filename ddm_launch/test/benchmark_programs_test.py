# A short run of `qa benchmark`: nodes and kernels produce all values of its table.
# SPDX-License-Identifier: BSD-3-Clause
from unittest import mock

from ddm_launch.command import processor
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


def test_processors_of_one_name_are_told_apart(tmp_path):
    (tmp_path / "cpuinfo").write_text("processor\t: 0\ncpu family\t: 26\nmodel\t\t: 2\nmodel name\t: AMD EPYC\n\nprocessor\t: 1\n")
    assert processor(tmp_path / "cpuinfo") == "AMD EPYC (family 26, model 2)"
    assert processor(tmp_path / "no_such_file") != ""

# A short run of `qa benchmark`: nodes and kernels produce all values of its table.
# SPDX-License-Identifier: BSD-3-Clause
from unittest import mock

from ddm_launch.command import processor
from ddm_qa import benchmark
from processes import run_experiment


def test_both_loops_and_all_parts_are_timed(tmp_path):
    code, output = run_experiment("--preset", "debug", "--seed", 1, "--trials", 1, "--out", tmp_path / "experiment_0")
    assert code == 0, output
    bench = benchmark.Benchmark(str(tmp_path), str(tmp_path))
    # The nodes report their progress ten times a second. A loop of 1000 images can end before the second report.
    with mock.patch.multiple(benchmark, RESTARTS=1, RETRAININGS=2, NUM_FRAMES=10000):
        bench.round_trips()
        bench.parts()
    for name in ("lockstep_round_trip", "bare_round_trip", "lockstep_round_trip_one_core", "bare_round_trip_one_core"):
        assert bench.rows[name][0] > 0.0, name
    for name in ("objective_gradient", "matrix_products", "retrain", "plan"):
        assert 0.0 < bench.rows[name][0] <= bench.rows[name][1], name


def test_processors_of_one_name_are_told_apart(tmp_path):
    (tmp_path / "cpuinfo").write_text("processor\t: 0\ncpu family\t: 26\nmodel\t\t: 2\nmodel name\t: AMD EPYC\n\nprocessor\t: 1\n")
    assert processor(tmp_path / "cpuinfo") == "AMD EPYC (family 26, model 2)"
    assert processor(tmp_path / "no_such_file") != ""

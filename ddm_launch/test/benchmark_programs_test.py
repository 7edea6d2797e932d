# A short run of `qa benchmark`: nodes and kernels produce all values of its table.
# SPDX-License-Identifier: BSD-3-Clause
from unittest import mock

from ddm_launch.command import distribution, processor
from ddm_qa import benchmark
from processes import run_experiment


def test_both_loops_and_all_kernels_are_timed(tmp_path):
    code, output = run_experiment("--preset", "debug", "--seed", 1, "--trials", 1, "--out", tmp_path / "experiment")
    assert code == 0, output
    bench = benchmark.Benchmark(str(tmp_path), str(tmp_path))
    # The nodes report their progress ten times a second. A loop of 1000 images can end before the second report.
    with mock.patch.object(benchmark, "RESTARTS", 1), mock.patch.object(benchmark, "NUM_FRAMES", 10000):
        bench.round_trips(mock.Mock())
    for name in ("lockstep_round_trip", "bare_round_trip", "lockstep_round_trip_one_core", "bare_round_trip_one_core"):
        assert bench.rows[name]["median_us"] > 0.0, name
    bench.kernels()
    for name in ("objective_gradient", "matrix_products", "retrain", "plan"):
        assert 0.0 < bench.rows[name]["median_us"] <= bench.rows[name]["p99_us"], name
    assert bench.plan_iterations > 0.0


def test_processors_of_one_name_are_told_apart_and_the_distribution_is_named(tmp_path):
    (tmp_path / "cpuinfo").write_text("processor\t: 0\ncpu family\t: 26\nmodel\t\t: 2\nmodel name\t: AMD EPYC\n\nprocessor\t: 1\n")
    (tmp_path / "os-release").write_text('ID=debian\n\nPRETTY_NAME="Debian GNU/Linux 12 (bookworm)"\n')
    assert processor(tmp_path / "cpuinfo") == "AMD EPYC (family 26, model 2)"
    assert processor(tmp_path / "no_such_file") != ""
    assert distribution(tmp_path / "os-release") == "Debian GNU/Linux 12 (bookworm)"
    assert distribution(tmp_path / "no_such_file") == "?"

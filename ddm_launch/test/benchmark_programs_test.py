# What `qa benchmark` runs, for a short time: nodes and kernels give what its table needs.
# SPDX-License-Identifier: BSD-3-Clause
from unittest import mock

from ddm_launch.command import distribution, processor
from ddm_qa import benchmark
from processes import call, find_program, run_experiment
from scratch_case import SharedScratchCase


class BenchmarkProgramsTest(SharedScratchCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.run_folder = cls.class_scratch + "/experiment"
        code, output = run_experiment("--preset", "debug", "--seed", 1, "--trials", 1, "--out", cls.run_folder)
        assert code == 0, output
        cls.bench = benchmark.Benchmark(cls.class_scratch, cls.class_scratch)

    def test_both_loops_give_their_round_trips(self):
        with mock.patch.object(benchmark, "RESTARTS", 1), mock.patch.object(benchmark, "NUM_FRAMES", 5000):
            self.bench.round_trips(mock.Mock())
        for name in ("lockstep_round_trip", "bare_round_trip", "lockstep_round_trip_one_core", "bare_round_trip_one_core"):
            self.assertGreater(self.bench.rows[name]["median_us"], 0.0, name)

    def test_kernels_tell_the_quantiles_of_single_calls(self):
        kernels = ("objective_gradient", "matrix_products", "retrain", "pca", "encode", "plan", "plan_cost_gradient",
                   "render", "read_bag")
        self.bench.kernels(only="-^plan_5_ms")
        for name in kernels:
            row = self.bench.rows[name]
            self.assertTrue(0.0 < row["median_us"] <= row["p99_us"], (name, row))
        self.assertGreater(self.bench.plan_iterations, 0.0)

    def test_plans_end_with_their_budget_and_plants_are_drawn(self):
        code, output = call([find_program("benchmark_kernels"), self.run_folder, "pendulum", "moving_tile",
                             "--benchmark_filter=^plan_5_ms|^render/[mp]|^view/", "--benchmark_format=csv"], 120.0)
        self.assertEqual(code, 0, output)
        medians = {name.split("/iterations")[0].strip('"'): float(rest.split(",")[1]) for name, _, rest in (
            line.partition(",") for line in output.splitlines() if "_median" in line)}
        self.assertEqual(sorted(medians), ["plan_5_ms", "render/moving_tile", "render/pendulum"], output)
        self.assertGreater(medians["plan_5_ms"], 5000.0)
        code, output = call([find_program("benchmark_kernels"), self.run_folder, "pendulumm"])
        self.assertEqual(code, 1)
        self.assertIn("pendulumm", output)

    def test_processors_of_one_name_are_told_apart_by_family_and_model(self):
        path = self.write("cpuinfo", "processor\t: 0\ncpu family\t: 26\nmodel\t\t: 2\n"
                          "model name\t: AMD EPYC\n\nprocessor\t: 1\nmodel name\t: other\n")
        self.assertEqual(processor(path), "AMD EPYC (family 26, model 2)")
        self.assertNotEqual(processor(self.file("no_such_file")), "")

    def test_the_distribution_is_named_as_its_own_file_has_it(self):
        path = self.write("os-release", 'ID=debian\n\nPRETTY_NAME="Debian GNU/Linux 12 (bookworm)"\n')
        self.assertEqual(distribution(path), "Debian GNU/Linux 12 (bookworm)")
        self.assertEqual(distribution(self.file("no_such_file")), "?")

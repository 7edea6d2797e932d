# What benchmark runs, for a short time: nodes, kernels and growth give what its table needs.
# SPDX-License-Identifier: BSD-3-Clause
from unittest import mock

from ddm_launch.command import distribution, processor
from ddm_qa import benchmark, growth
from processes import call, find_program, run_experiment
from scratch_case import ScratchCase


class BenchmarkProgramsTest(ScratchCase):
    def test_both_loops_give_their_round_trips(self):
        bench = benchmark.Benchmark(self.scratch, self.scratch)
        with mock.patch.object(benchmark, "RESTARTS", 1), mock.patch.object(benchmark, "NUM_FRAMES", 10000):
            bench.round_trips(mock.Mock())
        for name in ("lockstep_round_trip", "bare_round_trip", "lockstep_round_trip_one_core", "bare_round_trip_one_core"):
            self.assertGreater(bench.rows[name]["median_us"], 0.0, name)

    def test_kernels_tell_the_quantiles_of_single_calls(self):
        run = self.file("experiment")
        code, output = run_experiment("--preset", "debug", "--seed", 1, "--trials", 1, "--out", run)
        self.assertEqual(code, 0, output)
        bench = benchmark.Benchmark(self.scratch, self.scratch)
        bench.kernels()
        for name in ("objective_gradient", "matrix_products", "retrain", "pca", "encode", "plan", "plan_cost_gradient",
                     "render", "read_bag"):
            row = bench.rows[name]
            self.assertTrue(0.0 < row["median_us"] <= row["p99_us"], (name, row))
        self.assertGreater(bench.plan_iterations, 0.0)

    def test_each_plan_that_would_take_minutes_is_cut_short_by_its_budget(self):
        bench = benchmark.Benchmark(self.scratch, self.scratch)
        with mock.patch.object(benchmark, "NUM_PLANS", 20):
            bench.planning_budget()
        rows = [dict(zip(benchmark.BUDGET_COLUMNS, row)) for row in bench.budgets]
        self.assertEqual([row["load"] for row in rows], ["idle", "idle", "busy", "busy"])
        for row in rows:
            self.assertEqual(len(row), len(benchmark.BUDGET_COLUMNS), row)
            self.assertEqual((row["plans"], row["cut_short"]), ("20", "20"))
            self.assertGreater(float(row["median_ms"]), 5.0)

    def test_growth_gives_a_row(self):
        code, output = call([find_program("speed_growth"), "--frames", "200", "--size", "21"], 60.0)
        self.assertEqual(code, 0, output)
        frames, size, pca_us, objective_us, memory_mb = output.strip().split(",")
        self.assertEqual((frames, size), ("200", "21"))
        for value in (pca_us, objective_us, memory_mb):
            self.assertGreater(float(value), 0.0)

    def test_the_exponent_is_the_slope_of_logarithms(self):
        self.assertAlmostEqual(growth.exponent([1.0, 2.0, 4.0, 8.0], [3.0, 12.0, 48.0, 192.0]), 2.0)

    def test_processors_of_one_name_are_told_apart_by_family_and_model(self):
        path = self.write("cpuinfo", "processor\t: 0\ncpu family\t: 26\nmodel\t\t: 2\n"
                          "model name\t: AMD EPYC\n\nprocessor\t: 1\nmodel name\t: other\n")
        self.assertEqual(processor(path), "AMD EPYC (family 26, model 2)")
        self.assertNotEqual(processor(self.file("no_such_file")), "")

    def test_the_distribution_is_named_as_its_own_file_has_it(self):
        path = self.write("os-release", 'ID=debian\n\nPRETTY_NAME="Debian GNU/Linux 12 (bookworm)"\n')
        self.assertEqual(distribution(path), "Debian GNU/Linux 12 (bookworm)")
        self.assertEqual(distribution(self.file("no_such_file")), "?")

    def test_rendering_time_gives_a_row_for_the_learner_and_none_for_people_where_there_is_no_view(self):
        code, output = call([find_program("rendering_time"), "pendulum", "moving_tile"], 60.0)
        self.assertEqual(code, 0, output)
        header, *rows = [line.split(",") for line in output.strip().splitlines()]
        self.assertEqual(header, ["plant", "picture", "median_ms", "p99_ms", "cpu_median_ms", "first_ms"])
        self.assertEqual([row[:2] for row in rows], [["pendulum", "learner"], ["moving_tile", "learner"]])
        for row in rows:
            self.assertGreater(float(row[2]), 0.0)
            self.assertGreaterEqual(float(row[3]), float(row[2]))

    def test_rendering_time_names_a_plant_that_is_not_there(self):
        code, output = call([find_program("rendering_time"), "pendulumm"], 60.0)
        self.assertEqual(code, 1)
        self.assertIn("pendulumm", output)

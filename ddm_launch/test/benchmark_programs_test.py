#!/usr/bin/python3
# What benchmark runs, for a short time: nodes, kernels and growth give what its table needs.
# SPDX-License-Identifier: BSD-3-Clause
import glob
import importlib.util
import os
import shutil
import sys
import unittest
from unittest import mock

from roslib.packages import find_node
import rosunit

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import rooms  # noqa: E402, F401
from ddm_launch.command import Failure  # noqa: E402
from ddm_qa import benchmark  # noqa: E402
from processes import call, find_program, run_experiment  # noqa: E402
from scratch_case import ScratchCase  # noqa: E402


class BenchmarkProgramsTest(ScratchCase):
    def test_both_loops_give_their_round_trips(self):
        bench = benchmark.Benchmark(self.scratch, False, self.scratch)
        with mock.patch.object(benchmark, "RESTARTS", 1), mock.patch.object(benchmark, "NUM_FRAMES", 10000):
            bench.round_trips(mock.Mock())
        for name in ("lockstep_round_trip", "bare_round_trip", "lockstep_round_trip_one_core", "bare_round_trip_one_core"):
            self.assertGreater(bench.rows[name]["median_us"], 0.0, name)

    def test_kernels_tell_the_quantiles_of_single_calls(self):
        run = self.file("experiment")
        code, output = run_experiment("--preset", "debug", "--seed", 1, "--trials", 1, "--out", run)
        self.assertEqual(code, 0, output)
        bench = benchmark.Benchmark(self.scratch, False, self.scratch)
        bench.kernels()
        for name in ("objective_gradient", "matrix_products", "retrain", "pca", "encode", "plan", "plan_cost_gradient",
                     "render", "read_bag"):
            row = bench.rows[name]
            self.assertTrue(0.0 < row["median_us"] <= row["p99_us"], (name, row))
        self.assertGreater(bench.plan_iterations, 0.0)

    @unittest.skipUnless(importlib.util.find_spec("torch"), "PyTorch is not installed")
    def test_trainings_that_end_early_are_not_timed(self):
        from ddm_qa.torch_peers import times_us
        outcomes = [True, False, True, False, True]
        self.assertEqual(len(times_us(lambda: outcomes.pop(0), num_calls=2, warm_up=1)), 2)
        self.assertEqual(outcomes, [])  # one to warm up, two that ended early, two that count
        with self.assertRaisesRegex(ValueError, "ended early 3 times in 3"):
            times_us(lambda: False, num_calls=2)

    @unittest.skipUnless(importlib.util.find_spec("torch"), "PyTorch is not installed")
    def test_pytorch_computes_our_losses_before_it_is_timed(self):
        run = self.file("experiment")
        code, output = run_experiment("--preset", "debug", "--seed", 1, "--trials", 1, "--out", run)
        self.assertEqual(code, 0, output)
        bench = benchmark.Benchmark(self.scratch, True, self.scratch)
        bench.plan_iterations = 6.0
        for name in ("objective_gradient", "pca", "encode", "retrain", "plan"):
            bench.rows[name] = {}
        with mock.patch.object(benchmark, "ITERATIONS", 5):
            bench.peer()
        if find_node("ddm_launch", "torch_training"):
            for name in ("objective_gradient", "pca", "retrain"):
                self.assertGreater(bench.rows[name]["torch_cpp_us"], 0.0, name)
        for name, row in bench.rows.items():
            self.assertEqual(row["peer_median_us"], min(row[column] for column in benchmark.ONE_CORE if column in row), name)
            self.assertGreater(row["torch_script_2_threads_us"], 0.0, name)
        self.assertIn("blas", bench.torch["torch_blas"])

        self.assertRefusedInCpp()

        bags = glob.glob(os.path.join(run, "trial_*", "trial.bag"))
        shutil.copy(bags[0], bags[1])  # other data than the model's
        with self.assertRaisesRegex(Failure, r"V_R \+ V_P of PyTorch is .* off ours"):
            bench.peer()

    def assertRefusedInCpp(self):
        """What bench.peer() has saved, with another loss of ours."""
        if not find_node("ddm_launch", "torch_training"):
            return
        saved = self.file("peer.pt")
        code, output = call([sys.executable, "-c", "import sys, torch; m = torch.jit.load(sys.argv[1]); m.our_loss *= 1.001; "
                             "m.save(sys.argv[1])", saved], 60.0)
        self.assertEqual(code, 0, output)
        code, output = call([find_program("torch_training"), saved, "5", "20"], 60.0)
        self.assertEqual(code, 1, output)
        self.assertRegex(output, r"V_R \+ V_P of PyTorch in C\+\+ is 0\.0(0099|010)\d* off ours")

    def test_each_plan_that_would_take_minutes_is_cut_short_by_its_budget(self):
        bench = benchmark.Benchmark(self.scratch, False, self.scratch)
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


if __name__ == "__main__":
    rosunit.unitrun("ddm_launch", "benchmark_programs", BenchmarkProgramsTest)

#!/usr/bin/python3
# benchmark: what it makes of what its programs leave, and what it says where one of them fails.
# SPDX-License-Identifier: BSD-3-Clause
import json
import os
import sys
from unittest import mock

import rosunit

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import rooms  # noqa: E402, F401
from ddm_launch.command import Failure, distribution, processor  # noqa: E402
from ddm_qa import benchmark  # noqa: E402
from ddm_qa.processes import Programs  # noqa: E402
from processes import call_main  # noqa: E402
from run_files import read_rows, read_yaml  # noqa: E402
from scratch_case import ScratchCase  # noqa: E402

KERNELS = (("objective_gradient", 1000.0, 1500.0), ("matrix_products/64", 800.0, 900.0),
           ("matrix_products/128", 700.0, 950.0), ("plan", 300.0, 600.0))


class BenchmarkTest(ScratchCase):
    def call(self, *arguments):
        """Returns (exit code, output) of benchmark."""
        return call_main(benchmark.main, ["--out", self.out] + list(arguments))

    def leave(self, programs, what, command, **_):
        """Leaves what the programs would; the lock-step loop is twice as slow as the bare one."""
        run = os.path.join(programs.scratch, what)
        if what.endswith("experiment") or what.endswith("all_cores"):
            seed = command[command.index("--seed") + 1] if "--seed" in command else "0"
            run += "_" + seed if seed != "0" else ""
            self.write(os.path.join(run, "summary.yaml"), "finished: true\nwall_s: %g\n" % (9.5 + int(seed)))
            self.write(os.path.join(run, "config.yaml"), "version: made up\n")
        elif what.endswith("kernels"):
            rows = [{"name": name, "run_name": name + "/iterations:1", "aggregate_name": kind, "real_time": time,
                     "plan_iterations": 42.0}
                    for name, median, p99 in KERNELS
                    for kind, time in (("mean", 1.0), ("median", median), ("p99", p99))]
            self.write(command[-1].split("=")[1], json.dumps({"benchmarks": rows}))
        elif what in ("lockstep", "bare"):
            path = next(word.split(":=")[1] for word in command if word.startswith("out:="))
            time_us = (40.0 if what == "bare" else 80.0) - (30.0 if len(self.cores) == 1 else 0.0)
            self.write(path, "{median_us: %g}\n" % time_us)
        elif what == "planning_budget":
            return "%s,%s,5,2000,2000,5.1,5.2,5.3,6,1,1\n" % (command[2], "busy" if "--busy" in command else "idle")
        elif what == "peer in C++":
            self.assertEqual(command[-2:], [str(benchmark.ITERATIONS), "20"])
            return json.dumps({"objective_gradient": {"median_us": 1900.0, "p99_us": 2000.0}})
        elif "--save" in command:
            return "20\n"
        elif "torch_peers" in " ".join(command):
            time_us = 60000.0 if "--eager" in command else 50000.0 if command[-1] == "1" else 40000.0
            return json.dumps({"times": {"plan": {"median_us": time_us, "p99_us": 70000.0}}, "torch": "1.13",
                               "blas": "libopenblas.so"})
        return ""

    def useCores(self, _, cores):
        self.cores = cores

    def runWithStandIns(self, *arguments, roslaunch=None):
        roslaunch = roslaunch or (lambda programs, what, *words: self.leave(programs, what, words))
        self.cores = {3, 4}
        with mock.patch.object(benchmark.os, "sched_getaffinity", lambda _: self.cores), \
                mock.patch.object(benchmark.os, "sched_setaffinity", self.useCores), \
                mock.patch.object(Programs, "call", lambda *words, **more: self.leave(*words, **more)), \
                mock.patch.object(Programs, "roslaunch", roslaunch), \
                mock.patch.object(benchmark, "find_program", lambda name: name), \
                mock.patch.object(benchmark, "find_node", lambda _, name: [name]), \
                mock.patch.object(benchmark.importlib.util, "find_spec", lambda _: True):
            return self.call(*arguments)

    def test_the_table_has_a_row_for_each_name_and_products_in_their_best_blocking(self):
        code, output = self.runWithStandIns("--peers")
        self.assertEqual(code, 0, output)
        rows = read_rows(self.out, "speed.csv")
        self.assertEqual(rows[0], ["name", "median_us", "p99_us", "peer_median_us", "torch_eager_us", "torch_script_us",
                                   "torch_script_2_threads_us", "torch_cpp_us"])
        by_name = {row[0]: row[1:4] for row in rows[1:]}
        kernels = {"objective_gradient": ["1000", "1500", ""], "matrix_products/64": ["800", "900", ""],
                   "matrix_products/128": ["700", "950", ""], "matrix_products": ["700", "950", ""]}
        self.assertEqual(by_name, {
            **kernels, **{"efficient_" + name: row for name, row in kernels.items()},
            "experiment": ["9.5e+06", "", ""], "efficient_experiment": ["1.4e+07", "", ""],
            "efficient_experiment_all_cores": ["1.4e+07", "", ""], "plan": ["300", "600", "50000"],
            "efficient_plan": ["300", "600", ""], "objective_gradient": ["1000", "1500", "1900"], "ros_experiment": ["9.5e+06", "", ""],
            "lockstep_round_trip": ["80", "", ""], "bare_round_trip": ["40", "", ""],
            "lockstep_round_trip_one_core": ["50", "", ""], "bare_round_trip_one_core": ["10", "", ""]})
        self.assertEqual(self.cores, {3, 4})
        self.assertIn(["plan", "300", "600", "50000", "60000", "50000", "40000", ""], rows)
        self.assertIn(["objective_gradient", "1000", "1500", "1900", "", "", "", "1900"], rows)
        machine = read_yaml(self.out, "machine.yaml")
        self.assertEqual((machine["plan_iterations"], machine["torch_blas"]), (42.0, "libopenblas.so"))
        budgets = read_rows(self.out, "planning_budget.csv")
        self.assertEqual(budgets[0], benchmark.BUDGET_COLUMNS)
        self.assertEqual([row[:2] for row in budgets[1:]],
                         [[preset, load] for load in ("idle", "busy") for preset in ("paper", "efficient")])

    def test_without_peers_their_column_is_empty(self):
        code, output = self.runWithStandIns()
        self.assertEqual(code, 0, output)
        self.assertEqual({row[3] for row in read_rows(self.out, "speed.csv")[1:]}, {""})

    def test_missing_pytorch_is_told_before_anything_runs(self):
        with mock.patch.object(benchmark.importlib.util, "find_spec", lambda _: None):
            code, output = self.call("--peers")
        self.assertEqual(code, 1)
        self.assertIn("python3-torch", output)
        self.assertFalse(os.path.exists(self.out))

    def test_a_program_that_fails_is_named_with_its_last_words(self):
        bench = benchmark.Benchmark(self.out, False, self.scratch)
        with self.assertRaisesRegex(Failure, r"kernels: (.|\n)*3(.|\n)*out of luck"):
            bench.programs.call("kernels", ["sh", "-c", "echo out of luck >&2; exit 3"])

    def test_nodes_that_leave_nothing_are_named_with_their_last_words(self):
        bench = benchmark.Benchmark(self.out, False, self.scratch)
        with mock.patch.object(Programs, "roslaunch", lambda *_: "sim_node: out of luck\n"):
            with self.assertRaisesRegex(Failure, r"lockstep(.|\n)*out of luck"):
                bench.round_trips(mock.Mock())

    def test_what_was_timed_is_kept_where_the_nodes_leave_nothing(self):
        with mock.patch.object(benchmark.Benchmark, "ros_experiment", lambda _: None):
            code, _ = self.runWithStandIns(roslaunch=lambda *_: "")
        self.assertEqual(code, 1)
        names = [row[0] for row in read_rows(self.out, "speed.csv")]
        self.assertIn("objective_gradient", names)
        self.assertNotIn("lockstep_round_trip", names)

    def test_processors_of_one_name_are_told_apart_by_family_and_model(self):
        path = self.write(os.path.join(self.scratch, "cpuinfo"), "processor\t: 0\ncpu family\t: 26\nmodel\t\t: 2\n"
                          "model name\t: AMD EPYC\n\nprocessor\t: 1\nmodel name\t: other\n")
        self.assertEqual(processor(path), "AMD EPYC (family 26, model 2)")
        self.assertNotEqual(processor(os.path.join(self.scratch, "no_such_file")), "")

    def test_the_distribution_is_named_as_its_own_file_has_it(self):
        path = self.write(os.path.join(self.scratch, "os-release"), 'ID=debian\n\nPRETTY_NAME="Debian GNU/Linux 12 (bookworm)"\n')
        self.assertEqual(distribution(path), "Debian GNU/Linux 12 (bookworm)")
        self.assertEqual(distribution(os.path.join(self.scratch, "no_such_file")), "?")


if __name__ == "__main__":
    rosunit.unitrun("ddm_launch", "benchmark", BenchmarkTest)

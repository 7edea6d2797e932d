# Sweeps by GNU parallel: their files, that an interruption changes nothing, and what they refuse.
# SPDX-License-Identifier: BSD-3-Clause
import errno
import os
import pty
import re
import shutil
import signal
import unittest.mock

from ddm_launch.seed_script import SeedProgram
from ddm_launch.sweep_folder import SweepFolder
from processes import call, find_program, run_experiment
from run_files import COLUMNS, differences, expected_files, files_in, read_bytes, read_rows, read_yaml
from scratch_case import SharedScratchCase
from sweeps import (Sweep, is_finished, processes_with, programs_of, seed_folder, snapshot, sweep,
                    wait_for)

LONG = 12  # trials: enough to see a seed at its work


class SweepTest(SharedScratchCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.reference = os.path.join(cls.class_scratch, "reference")
        cls.code, cls.output = sweep("--preset", "debug", "--seeds", "0:4", "--trials", 1, "--out", cls.reference)

    def debug(self, seeds="0:4", trials=1, out=None):
        return ["--preset", "debug", "--seeds", seeds, "--trials", trials, "--out", out or self.out]

    def copyReference(self):
        """The reference sweep of seeds 0 ... 3 with one trial, in the folder of this test."""
        shutil.copytree(self.reference, self.out)

    def assertEnds(self, code, words, *arguments, **kwargs):
        actual, output = sweep(*arguments, **kwargs)
        self.assertEqual(actual, code, output)
        for word in words:
            self.assertIn(word, output)
        return output

    def assertTableIsComplete(self, seeds, trials=1):
        """sweep.csv: one header, then exactly the rows of these seeds."""
        lines = read_bytes(self.out, "sweep.csv").splitlines()
        expected = [read_bytes(seed_folder(self.out, seed), "trials.csv").splitlines() for seed in seeds]
        self.assertEqual(lines, expected[0][:1] + [row for table in expected for row in table[1:trials + 2]])
        rows = read_rows(self.out, "sweep.csv")[1:]
        self.assertEqual([row[:2] for row in rows],
                         [[str(seed), str(k)] for seed in seeds for k in range(trials + 1)])

    def assertNothingRuns(self):
        """Nothing that knows the folder is left, or it ends by itself at once."""
        wait_for(lambda: not processes_with([self.out]), "the end of all processes", 10.0)

    def test_all_seeds_are_run_and_their_rows_collected(self):
        self.assertEqual(self.code, 0, self.output)
        self.out = self.reference
        self.assertTableIsComplete(range(4))
        self.assertRegex(self.output, r"4 of 4 seeds finished.*\b0\.\d\d\b")
        self.assertIn(os.path.join(self.reference, "sweep.csv"), self.output)
        own = [name for name in files_in(self.reference) if not name.startswith(("seed_", "logs/"))]
        self.assertEqual(own, ["joblog.tsv", "run_seed.sh", "sweep.csv", "sweep.yaml"])

    def test_a_seed_gives_the_same_files_as_run_experiment(self):
        single = self.file("single")
        code, output = run_experiment("--preset", "debug", "--seed", 2, "--trials", 1, "--out", single)
        self.assertEqual(code, 0, output)
        self.assertEqual(files_in(seed_folder(self.reference, 2)), expected_files(1))
        self.assertEqual(differences(single, seed_folder(self.reference, 2), expected_files(1)), [])

    def test_each_seed_is_a_job_of_gnu_parallel_with_a_log(self):
        with open(os.path.join(self.reference, "joblog.tsv")) as stream:
            jobs = [line.split("\t") for line in stream.read().splitlines()]
        self.assertEqual(jobs[0][6:], ["Exitval", "Signal", "Command"])
        self.assertEqual([job[6] for job in jobs[1:]], ["0"] * 4)
        for seed in range(4):
            log = read_bytes(self.reference, "logs", "seed_%04d.log" % seed).decode()
            self.assertIn("preset debug, plant pendulum, seed %d, 1 trials" % seed, log)

    def test_a_file_gets_a_line_for_each_seed_and_no_bar(self):
        lines = [line for line in self.output.splitlines() if line.startswith("seed ")]
        self.assertEqual(sorted(line.split(" (")[0] for line in lines), ["seed %d finished" % k for k in range(4)])
        self.assertEqual([line.split(" (")[1] for line in lines], ["%d of 4)" % k for k in range(1, 5)])
        self.assertNotIn("\r", self.output)
        self.assertNotIn("Tange", self.output)

    def test_a_terminal_gets_the_bar_of_gnu_parallel(self):
        try:
            master, slave = pty.openpty()
        except OSError as error:
            self.skipTest("this system gives no terminal: %s" % error)
        self.addCleanup(os.close, master)
        process = Sweep(*self.debug("0:2", 0), output=slave)
        os.close(slave)
        shown = b""
        while b"results:" not in shown:
            shown += os.read(master, 4096)
        self.assertEqual(process.waitForEnd(30.0), 0)
        self.assertIn(b"100% 2:0", shown)
        self.assertNotIn(b"seed 0 finished", shown)

    def test_a_finished_sweep_runs_nothing_again(self):
        self.copyReference()
        before = snapshot(self.out)
        output = self.assertEnds(0, ["0 of 4 seeds to run", "4 of 4 seeds finished"], *self.debug())
        self.assertNotIn("seed 0 finished (", output)
        after = snapshot(self.out)
        self.assertEqual(after.pop("sweep.csv")[1], before.pop("sweep.csv")[1])
        self.assertEqual(after, before)

    def test_seeds_of_other_versions_are_collected_and_told(self):
        self.copyReference()
        table = os.path.join(seed_folder(self.out, 1), "trials.csv")
        with open(table) as stream:
            text = stream.read()
        here = read_yaml(seed_folder(self.out, 0), "config.yaml")["version"]
        with open(table, "w") as stream:
            stream.write(text.replace(here, "0.0.1 (old)"))
        config = os.path.join(seed_folder(self.out, 1), "config.yaml")
        with open(config) as stream:
            text = re.sub("^version: .*$", "version: 0.0.1 (old)", stream.read(), flags=re.MULTILINE)
        with open(config, "w") as stream:
            stream.write(text)
        output = self.assertEnds(0, ["4 of 4 seeds finished", "2 versions", "0.0.1 (old)"], *self.debug())
        rows = read_rows(self.out, "sweep.csv")
        self.assertEqual(rows[0], COLUMNS)
        versions = [row[COLUMNS.index("version")] for row in rows[1:]]
        self.assertEqual(versions, [here] * 2 + ["0.0.1 (old)"] * 2 + [here] * 4, output)

    def test_seeds_may_grow_and_any_range_of_them_be_collected(self):
        self.copyReference()
        before = snapshot(seed_folder(self.out, 3))
        self.assertEnds(0, ["1 of 2 seeds to run"], *self.debug("3:5"))
        self.assertTableIsComplete([3, 4])
        self.assertEqual(snapshot(seed_folder(self.out, 3)), before)

    def test_trials_may_grow_and_a_table_of_fewer_is_cut(self):
        self.copyReference()
        self.assertEnds(0, ["2 of 2 seeds to run"], *self.debug("0:2", 3))
        self.assertTableIsComplete([0, 1], 3)
        self.assertIn("after trial 1", read_bytes(self.out, "logs", "seed_0000.log").decode())
        single = self.file("single")
        run_experiment("--preset", "debug", "--seed", 1, "--trials", 3, "--out", single)
        self.assertEqual(differences(single, seed_folder(self.out, 1), expected_files(3)), [])
        self.assertEnds(0, ["0 of 4 seeds to run"], *self.debug("0:4", 1))
        self.assertTableIsComplete(range(4), 1)

    def test_a_sweep_that_was_killed_goes_on_as_if_nothing_had_happened(self):
        process = Sweep(*self.debug("0:3", LONG), "--jobs", 1)
        self.addCleanup(process.stop)
        trials_csv = os.path.join(seed_folder(self.out, 1), "trials.csv")
        wait_for(lambda: is_finished(self.out, 0) and os.path.exists(trials_csv), "the middle of the sweep")
        process.kill_group()
        self.assertFalse(is_finished(self.out, 1))
        self.assertNothingRuns()
        before = snapshot(seed_folder(self.out, 0))

        self.assertEnds(0, ["2 of 3 seeds to run", "3 of 3 seeds finished"], *self.debug("0:3", LONG))
        self.assertEqual(snapshot(seed_folder(self.out, 0)), before)
        self.assertIn("after trial", read_bytes(self.out, "logs", "seed_0001.log").decode())
        self.assertTableIsComplete(range(3), LONG)
        single = self.file("single")
        run_experiment("--preset", "debug", "--seed", 1, "--trials", LONG, "--out", single)
        self.assertEqual(differences(single, seed_folder(self.out, 1), expected_files(LONG)), [])

    def test_a_seed_that_was_killed_is_named_and_the_others_are_collected(self):
        process = Sweep(*self.debug("0:3", LONG))
        self.addCleanup(process.stop)
        program = wait_for(lambda: programs_of(seed_folder(self.out, 1)), "the program of seed 1")[0]
        os.kill(program, signal.SIGKILL)
        self.assertEqual(process.waitForEnd(60.0), 1)
        for words in ("2 of 3 seeds finished", "seed 1: ", "signal KILL", "logs/seed_0001.log",
                      "sweep: "):
            self.assertIn(words, process.output)
        self.assertTableIsComplete([0, 2], LONG)
        self.assertEnds(0, ["1 of 3 seeds to run", "3 of 3 seeds finished"], *self.debug("0:3", LONG))
        self.assertTableIsComplete(range(3), LONG)

    def test_a_signal_ends_all_seeds_and_the_same_command_goes_on(self):
        for number, code in ((signal.SIGINT, 130), (signal.SIGTERM, 143)):
            process = Sweep(*self.debug("0:2", LONG), "--jobs", 1)
            self.addCleanup(process.stop)
            wait_for(lambda: programs_of(seed_folder(self.out, 0)), "the program of seed 0")
            process.send(number)
            self.assertEqual(process.waitForEnd(20.0), code, process.output)
            self.assertIn("SIG", process.output)
            self.assertIn("seed 1: ", process.output)
            self.assertNothingRuns()
        self.assertEnds(0, ["2 of 2 seeds finished"], *self.debug("0:2", LONG))

    def test_a_second_sweep_in_the_same_folder_is_refused(self):
        process = Sweep(*self.debug("0:1", 999))
        self.addCleanup(process.stop)
        wait_for(lambda: programs_of(seed_folder(self.out, 0)), "the program of seed 0")
        self.assertEnds(1, ["is running", self.out], *self.debug("1:2"))
        self.assertTrue(process.isRunning())
        process.send(signal.SIGTERM)
        process.waitForEnd(20.0)
        self.assertNothingRuns()

    def test_a_folder_of_another_sweep_is_refused_and_left_as_it_is(self):
        self.copyReference()
        before = snapshot(self.out)
        config = self.write("more.yaml", "mpc: {epsilon: 0.4}\n")
        for words, arguments in (
                (["options: ['--preset', 'debug'] there", "pendulum_gravity"], self.debug() + ["--plant", "pendulum_gravity"]),
                (["'debug'] there, [] here"], ["--seeds", "0:4", "--trials", 1, "--out", self.out]),
                (["'debug'] there", "more.yaml"], self.debug() + ["--", "--config", config])):
            self.assertEnds(1, words + ["another sweep", self.out], *arguments)
        self.assertEqual(snapshot(self.out), before)

    def test_a_seed_of_another_experiment_is_refused_by_its_program_and_named(self):
        code, output = run_experiment("--preset", "debug", "--plant", "pendulum_gravity", "--seed", 1, "--trials", 0,
                                      "--out", seed_folder(self.out, 1))
        self.assertEqual(code, 0, output)
        before = snapshot(seed_folder(self.out, 1))
        self.assertEnds(1, ["1 of 2 seeds finished", "seed 1: - ", "there, ", "logs/seed_0001.log"],
                        *self.debug("0:2"))
        self.assertEqual(snapshot(seed_folder(self.out, 1)), before)
        self.assertTableIsComplete([0])

    def test_a_configuration_that_changed_between_two_calls_is_not_mixed_in(self):
        config = self.write("more.yaml", "mpc: {epsilon: 0.4}\n")
        self.assertEnds(0, ["1 of 1 seeds finished"], *self.debug("0:1"), "--", "--config", config)
        self.write("more.yaml", "mpc: {epsilon: 0.3}\n")
        self.assertEnds(1, ["1 of 2 seeds finished", "seed_0001", "mpc/epsilon: 0.4 there, 0.3 here"], *self.debug("0:2"),
                        "--", "--config", config)
        self.assertTableIsComplete([0])

    def test_single_values_are_those_of_all_seeds(self):
        self.assertEnds(0, [], *self.debug("0:1", 0), "--set", "mpc/epsilon=0.3", "--set", "model/encoder_widths=[30, 12]")
        config = read_yaml(seed_folder(self.out, 0), "config.yaml")
        self.assertEqual((config["mpc"]["epsilon"], config["model"]["encoder_widths"]), (0.3, [30, 12]))
        self.assertEnds(1, ["another sweep", "mpc/epsilon=0.2"], *self.debug("0:1", 0), "--set", "mpc/epsilon=0.2")

    def test_a_table_that_makes_no_sense_is_named(self):
        self.copyReference()
        path = os.path.join(seed_folder(self.out, 2), "trials.csv")
        rows = read_bytes(path).decode().splitlines()
        for damaged in (rows[:2], [row.replace("2,", "3,", 1) for row in rows], []):
            self.write(path, "\n".join(damaged) + "\n")
            self.assertEnds(1, ["3 of 4 seeds finished", path, "2 rows of seed 2"], *self.debug())
            self.assertTableIsComplete([0, 1, 3])

    def test_bad_options_are_refused_by_name_before_anything_is_made(self):
        known = self.debug()
        for words, arguments in (
                (["--seeds"], ["--out", self.out]),
                (["--out"], ["--seeds", "0:4"]),
                (["must be A:B", "'4:4'"], self.debug("4:4")),
                (["must be A:B", "'4:2'"], self.debug("4:2")),
                (["must be A:B", "'-1:2'"], ["--preset", "debug", "--seeds=-1:2", "--out", self.out]),
                (["must be A:B", "'4'"], self.debug("4")),
                (["must be A:B", "'0:1000000'", "at most 100000"], self.debug("0:1000000")),
                (["--seed", "2147483648"], self.debug("2147483648:2147483649")),
                (["--trials", "'x'"], self.debug(trials="x")),
                (["experiment/trials", "1000"], self.debug(trials=1000)),
                (["--jobs", "whole number >= 1, got '0'"], known + ["--jobs", 0]),
                (["--hosts", "/no/hosts"], known + ["--hosts", "/no/hosts"]),
                (["--hosts and --slurm"], known + ["--hosts", __file__, "--slurm"]),
                (["unknown preset 'papier'", "efficient, paper"], known + ["--preset", "papier"]),
                (["unknown plant 'sim'"], known + ["--plant", "sim"]),
                (["nonsense"], known + ["--nonsense"]),
                (["nonsense"], known + ["--", "--nonsense"]),
                (["/no/file.yaml"], known + ["--", "--config", "/no/file.yaml"]),
                (["--seed=3 after '--'"], known + ["--", "--seed=3"]),
                (["--help after '--'"], known + ["--", "--help"]),
                (["invalid choice: 'simulate'"], known + ["--program", "simulate"]),
                (["option of run_experiment"], known + ["--program", "prediction_experiment"])):
            self.assertEnds(2, words, *arguments)
        self.assertFalse(os.path.exists(self.out))

    def test_a_folder_that_cannot_be_written_is_named(self):
        for out in (self.write("plain_file", ""), "/proc/ddm"):
            self.assertEnds(1, ["cannot write", out], *self.debug(out=out))

    def test_a_file_of_the_sweep_that_cannot_be_completed_is_named(self):
        self.limitFiles(10)
        self.assertEnds(1, ["sweep: ", self.out, os.strerror(errno.EFBIG)], *self.debug())
        self.assertEqual(files_in(self.out), [])

    def test_of_a_seed_that_said_nothing_it_is_told_whether_the_disk_is_full(self):
        with SweepFolder(self.out, SeedProgram("run_experiment", 1, ["--preset", "debug"])) as folder:
            self.write(folder.log(1), "")
            self.assertIn(folder.log(1), folder.last_words(1))
            self.assertNotIn("disk", folder.last_words(1))
            space = shutil.disk_usage(self.out)
            with unittest.mock.patch("shutil.disk_usage", lambda _path: space._replace(free=4096)):
                self.assertIn("disk", folder.last_words(1))

    def test_a_missing_engine_is_named_with_its_package(self):
        self.assertEnds(1, ["not installed", "apt-get install parallel"], *self.debug(),
                        environment={"PATH": self.scratch})
        os.chmod(self.write("parallel", "#!/bin/sh\necho another\n"), 0o755)
        self.assertEnds(1, ["not GNU", "apt-get install parallel"], *self.debug(),
                        environment={"PATH": self.scratch + ":/usr/bin:/bin"})

    def test_help_names_every_option_and_has_an_example(self):
        code, output = call([find_program("sweep"), "--help"])
        self.assertEqual(code, 0)
        for words in ("--preset", "--plant", "--seeds A:B", "--trials", "--out", "--jobs", "--hosts", "--slurm",
                      "--program", "-- ", "SBATCH_PARTITION", "example:", "rosrun ddm_launch sweep --preset paper"):
            self.assertIn(words, output)

    def test_folders_with_odd_names_and_relative_ones_will_do(self):
        self.out = self.file("it's a \"sweep\" of 100%")
        self.assertEnds(0, [], *self.debug("7:8", 0, out=os.path.basename(self.out)), folder=self.scratch)
        self.assertTableIsComplete([7], 0)

    def test_predictions_are_collected_too(self):
        arguments = ["--program", "prediction_experiment", "--preset", "debug", "--seeds", "0:2", "--out", self.out,
                     "--set", "training/max_iterations=5"]
        self.assertEnds(0, ["prediction_experiment", "2 of 2 seeds finished"], *arguments)
        rows = read_rows(self.out, "sweep.csv")
        self.assertEqual(rows[0][:3], ["seed", "steps", "num_predictions"])
        self.assertEqual([row[:2] for row in rows[1:]], [[str(seed), str(k)] for seed in (0, 1) for k in range(1, 9)])
        self.assertEnds(0, ["0 of 2 seeds to run"], *arguments)
        self.assertEqual(read_yaml(self.out, "sweep.yaml")["program"], "prediction_experiment")

# Sweeps as Slurm job arrays: their files, that an interruption changes nothing, and what they refuse.
# SPDX-License-Identifier: BSD-3-Clause
import os
import re
import signal

from ddm_launch.slurm import index_ranges
from processes import run_experiment
from run_files import differences, expected_files, files_in, read_bytes, read_rows
from scratch_case import SharedScratchCase
from slurm_cluster import SlurmCluster
from sweeps import (Sweep, is_finished, processes_with, programs_of, seed_folder, snapshot, sweep,
                    wait_for)


class SlurmTest(SharedScratchCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.cluster = SlurmCluster(cls.class_scratch)
        cls.addClassCleanup(cls.stopCluster)

    @classmethod
    def stopCluster(cls):
        cls.cluster.stop()
        wait_for(lambda: not processes_with([cls.class_scratch]), "the end of all daemons", 10.0)

    def debug(self, seeds, trials):
        return ["--preset", "debug", "--seeds", seeds, "--trials", trials, "--out", self.out, "--slurm"]

    def start(self, *arguments):
        process = Sweep(*arguments, environment=self.cluster.environment)
        self.addCleanup(process.stop)
        return process

    def assertEnds(self, code, words, *arguments, **environment):
        actual, output = sweep(*arguments, environment=dict(self.cluster.environment, **environment))
        self.assertEqual(actual, code, output)
        for word in words:
            self.assertIn(word, output)
        return output

    def assertTableIsComplete(self, seeds, trials):
        rows = read_rows(self.out, "sweep.csv")[1:]
        self.assertEqual([row[:2] for row in rows],
                         [[str(seed), str(k)] for seed in seeds for k in range(trials + 1)])

    def assertNothingRuns(self):
        self.assertEqual(self.cluster.tasks(), [])
        wait_for(lambda: not processes_with([self.out]), "the end of all processes", 10.0)
        self.assertNotIn("slurm_job", files_in(self.out))

    def jobOf(self, output):
        return re.search(r"Slurm job (\d+)", output).group(1)

    def log(self, seed):
        return read_bytes(self.out, "logs", "seed_%04d.log" % seed).decode()

    def test_seeds_are_the_tasks_of_a_job_array(self):
        output = self.assertEnds(0, ["4 of 4 seeds finished", "seed 3 finished ("], *self.debug("0:4", 1))
        job = self.jobOf(output)
        jobs = self.cluster.call("scontrol", "show", "job", job)
        for seed in range(4):
            self.assertRegex(jobs, r"ArrayJobId=%s ArrayTaskId=%d " % (job, seed))
            self.assertIn("task %s_%d of Slurm" % (job, seed), self.log(seed))
            self.assertEqual(files_in(seed_folder(self.out, seed)), expected_files(1))
        self.assertEqual(jobs.count("JobState=COMPLETED"), 4)
        self.assertTableIsComplete(range(4), 1)
        own = [name for name in files_in(self.out) if not name.startswith(("seed_", "logs/"))]
        self.assertEqual(own, ["run_seed.sh", "sweep.csv", "sweep.yaml"])
        single = self.file("single")
        run_experiment("--preset", "debug", "--seed", 3, "--trials", 1, "--out", single)
        self.assertEqual(differences(single, seed_folder(self.out, 3), expected_files(1)), [])

    def test_gnu_parallel_goes_on_where_slurm_ended_and_the_other_way_round(self):
        self.assertEnds(0, ["1 of 1 seeds finished"], *self.debug("1:2", 1))
        before = snapshot(seed_folder(self.out, 1))
        self.assertEnds(0, ["1 of 2 seeds to run"], *self.debug("0:2", 1)[:-1])
        output = self.assertEnds(0, ["1 of 3 seeds to run"], *self.debug("0:3", 1))
        self.assertIn("ArrayTaskId=2 ", self.cluster.call("scontrol", "show", "job", self.jobOf(output)))
        self.assertEqual(snapshot(seed_folder(self.out, 1)), before)
        self.assertTableIsComplete(range(3), 1)

    def test_a_task_that_was_cancelled_is_named_and_run_again(self):
        process = self.start(*self.debug("0:4", 12))
        process.waitForText("Slurm job ", 30.0)
        wait_for(lambda: programs_of(seed_folder(self.out, 1)), "the program of seed 1")
        self.cluster.call("scancel", self.jobOf(process.output) + "_1")
        self.assertEqual(process.waitForEnd(60.0), 1, process.output)
        self.assertIn("3 of 4 seeds finished", process.output)
        self.assertRegex(process.output, r"seed 1: .*logs/seed_0001.log")
        self.assertIn("CANCELLED", self.log(1))
        self.assertTableIsComplete([0, 2, 3], 12)
        before = snapshot(seed_folder(self.out, 0))

        output = self.assertEnds(0, ["1 of 4 seeds to run", "4 of 4 seeds finished"], *self.debug("0:4", 12))
        self.assertIn("ArrayTaskId=1 ", self.cluster.call("scontrol", "show", "job", self.jobOf(output)))
        self.assertEqual(snapshot(seed_folder(self.out, 0)), before)
        self.assertTableIsComplete(range(4), 12)
        self.assertNothingRuns()

    def test_ctrl_c_cancels_the_job(self):
        process = self.start(*self.debug("0:2", 999), "--jobs", 1)
        process.waitForText("Slurm job ", 30.0)
        wait_for(lambda: programs_of(seed_folder(self.out, 0)), "the program of seed 0")
        self.assertEqual(sorted(self.cluster.tasks()), ["PENDING", "RUNNING"])
        self.assertIn("ArrayTaskThrottle=1",
                      self.cluster.call("scontrol", "show", "job", self.jobOf(process.output)))
        process.send(signal.SIGINT)
        self.assertEqual(process.waitForEnd(30.0), 130, process.output)
        self.assertNothingRuns()

    def test_the_job_of_a_sweep_that_has_ended_goes_on_and_is_waited_for(self):
        process = self.start(*self.debug("0:2", 12), "--jobs", 1)
        wait_for(lambda: is_finished(self.out, 0) and programs_of(seed_folder(self.out, 1)), "the middle of the sweep")
        job = self.jobOf(process.output)
        process.kill_group()
        self.assertEqual(self.cluster.tasks(), ["RUNNING"])
        before = snapshot(seed_folder(self.out, 0))
        process = self.start(*self.debug("0:3", 12))
        process.waitForText("Slurm job %s\n" % job, 30.0)
        process.send(signal.SIGTERM)
        self.assertEqual(process.waitForEnd(30.0), 143, process.output)
        output = self.assertEnds(0, ["Slurm job %s\n" % job, "1 of 3 seeds to run", "3 of 3 seeds finished"],
                                 *self.debug("0:3", 12))
        self.assertRegex(self.cluster.call("scontrol", "show", "job", job + "_1"), "JobState=COMPLETED")
        self.assertNotIn("CANCELLED", output)
        self.assertEqual(snapshot(seed_folder(self.out, 0)), before)
        self.assertTableIsComplete(range(3), 12)
        self.assertNothingRuns()

    def test_what_sbatch_refuses_is_told_with_its_words(self):
        self.assertEnds(1, ["job array 0-1", "nonsense", "SBATCH_PARTITION"], *self.debug("0:2", 0),
                        SBATCH_PARTITION="nonsense")
        self.assertEnds(1, ["job array 1001", "MaxArraySize"], *self.debug("1001:1002", 0))
        self.assertNothingRuns()

    def test_a_machine_without_slurm_is_told_what_to_install(self):
        self.assertEnds(1, ["sbatch", "apt-get install slurm-client"], *self.debug("0:2", 0),
                        PATH=self.scratch)
        self.assertFalse(os.path.exists(self.out))

    def test_indices_are_written_as_ranges(self):
        for seeds, text in (([3], "3"), ([0, 1, 2, 5], "0-2,5"), ([0, 2, 3, 7, 8], "0,2-3,7-8")):
            self.assertEqual(index_ranges(seeds), text)

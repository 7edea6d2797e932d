# Sweeps over ssh hosts, played by this machine: seeds are spread, hosts may be gone, nothing is left running.
# SPDX-License-Identifier: BSD-3-Clause
import os

from run_files import read_rows
from scratch_case import ScratchCase
from ssh_hosts import SshHosts
from sweeps import Sweep, processes_with, programs_of, seed_folder, wait_for


class SweepHostsTest(ScratchCase):
    def setUp(self):
        super().setUp()
        self.hosts = SshHosts(self.scratch)
        self.addCleanup(self.hosts.stop)

    def start(self, hosts, seeds, trials):
        list_of_hosts = self.write("hosts", "\n".join(hosts) + "\n")
        # a shell on another machine knows nothing of this workspace: sshd hands no variable of ours on
        return Sweep("--preset", "debug", "--seeds", seeds, "--trials", trials, "--jobs", 1, "--hosts", list_of_hosts,
                     "--out", self.out, environment={"PARALLEL_SSH": self.hosts.ssh_command})

    def test_seeds_are_spread_over_the_hosts_that_answer(self):
        process = self.start(["first", "second", ":", "gone.invalid"], "0:6", 1)
        self.assertEqual(process.waitForEnd(60.0), 0, process.output)
        self.assertIn("6 of 6 seeds finished", process.output)
        self.assertIn("gone.invalid", process.output)
        with open(os.path.join(self.out, "joblog.tsv")) as stream:
            hosts = {line.split("\t")[1] for line in stream.read().splitlines()[1:]}
        self.assertEqual(hosts, {"first", "second", ":"})
        self.assertEqual([row[0] for row in read_rows(self.out, "sweep.csv")[1:]], [str(k // 2) for k in range(12)])

    def test_hosts_that_are_all_gone_leave_all_seeds_to_be_run(self):
        process = self.start(["gone.invalid"], "0:2", 0)
        self.assertEqual(process.waitForEnd(60.0), 1, process.output)
        for words in ("gone.invalid", "0 of 2 seeds finished", "seed 1: it has not written anything"):
            self.assertIn(words, process.output)

    def test_seeds_on_other_hosts_end_with_a_sweep_that_is_killed(self):
        process = self.start(["first"], "0:1", 999)
        self.addCleanup(process.stop)
        wait_for(lambda: programs_of(seed_folder(self.out, 0)), "the program of seed 0")
        process.kill_group()
        wait_for(lambda: not processes_with([self.out]), "the end of all processes", 10.0)

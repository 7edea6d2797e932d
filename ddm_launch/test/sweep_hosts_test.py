# Sweeps over ssh hosts, simulated on this machine: seeds are distributed, hosts may fail, and all processes end.
# SPDX-License-Identifier: BSD-3-Clause
import os
import socket
import subprocess

import pytest

from processes import Process, free_port
from run_files import read_bytes, read_rows
from sweeps import Sweep, assert_nothing_runs, debug, programs_of, seed_folder, wait_for

SSHD_CONFIG = """\
Port {port}
ListenAddress 127.0.0.1
HostKey {folder}/host_key
AuthorizedKeysFile {folder}/user_key.pub
PidFile none
StrictModes no
UsePAM no
PasswordAuthentication no
SetEnv PATH={folder}/bin:/usr/bin:/bin
# A login shell may print something.
ForceCommand echo Welcome; echo Welcome >&2; eval "$SSH_ORIGINAL_COMMAND"
"""
SSH_CONFIG = """\
Host first second
  HostName 127.0.0.1
  Port {port}
  IdentityFile {folder}/user_key
  IdentitiesOnly yes
Host *
  BatchMode yes
  UserKnownHostsFile {folder}/known_hosts
  StrictHostKeyChecking no
  LogLevel ERROR
"""
PRIVILEGE_SEPARATION = "/run/sshd"  # sshd needs this folder when root starts it; some systems create it only at boot


class SshHosts:
    """Simulates the hosts `first` and `second`. `ssh_command` is the ssh command for them."""

    def __init__(self, folder):
        self.folder = folder
        self.port = free_port()
        self.ssh_command = "ssh -F %s/ssh_config" % folder
        if os.getuid() == 0:  # the folder stays: another sshd on this machine may have come to need it
            os.makedirs(PRIVILEGE_SEPARATION, 0o755, exist_ok=True)
        # In a bare chroot without /sys, lscpu prints warnings, which GNU parallel reports as its own. If lscpu fails,
        # GNU parallel counts the cores in /proc.
        os.mkdir(os.path.join(folder, "bin"))
        with open(os.path.join(folder, "bin", "lscpu"), "w") as stream:
            stream.write("#!/bin/sh\nexit 1\n")
        os.chmod(os.path.join(folder, "bin", "lscpu"), 0o755)
        for name in ("host_key", "user_key"):
            subprocess.check_call(["ssh-keygen", "-q", "-t", "ed25519", "-N", "", "-f", os.path.join(folder, name)])
        for name, text in (("sshd_config", SSHD_CONFIG), ("ssh_config", SSH_CONFIG)):
            with open(os.path.join(folder, name), "w") as stream:
                stream.write(text.format(folder=folder, port=self.port))
        # sshd ends with this process even if this process is killed
        self._sshd = Process(["setpriv", "--pdeathsig", "KILL", "/usr/sbin/sshd", "-D", "-e", "-f",
                              os.path.join(folder, "sshd_config")])
        wait_for(self._answers, "sshd")

    def _answers(self):
        if not self._sshd.isRunning():
            raise AssertionError("sshd has ended: %s" % self._sshd.output)
        with socket.socket() as probe:
            return probe.connect_ex(("127.0.0.1", self.port)) == 0

    def stop(self):
        self._sshd.stop()


@pytest.fixture(name="start")
def make_start(tmp_path):
    """Returns a function that starts a sweep over hosts."""
    hosts = SshHosts(str(tmp_path))

    def start(names, seeds, trials):
        (tmp_path / "hosts").write_text("\n".join(names) + "\n")
        # sshd passes on no variable of this workspace, as on another machine.
        return Sweep(*debug(str(tmp_path / "out"), seeds, trials), "--jobs", 1, "--hosts", tmp_path / "hosts",
                     environment={"PARALLEL_SSH": hosts.ssh_command})
    yield start
    hosts.stop()


def test_seeds_are_spread_over_the_hosts_that_answer(start, tmp_path):
    process, out = start(["first", "second", ":", "gone.invalid"], "0:6", 1), str(tmp_path / "out")
    assert process.waitForEnd(60.0) == 0, process.output
    assert "6 of 6 seeds finished" in process.output and "gone.invalid" in process.output
    jobs = read_bytes(out, "joblog.tsv").decode().splitlines()[1:]
    assert {line.split("\t")[1] for line in jobs} == {"first", "second", ":"}
    assert [row[0] for row in read_rows(out, "sweep.csv")[1:]] == [str(k // 2) for k in range(12)]


def test_hosts_that_are_all_gone_leave_all_seeds_to_be_run(start):
    process = start(["gone.invalid"], "0:2", 0)
    assert process.waitForEnd(60.0) == 1, process.output
    assert "none of the hosts in" in process.output and "gone.invalid" in process.output


def test_seeds_on_other_hosts_end_with_a_sweep_that_is_killed(start, tmp_path):
    with start(["first"], "0:1", 999) as process:
        wait_for(lambda: not process.isRunning() or programs_of(seed_folder(str(tmp_path / "out"), 0)), "the program of seed 0")
        assert process.isRunning(), process.output
        process.kill_group()
    assert_nothing_runs(str(tmp_path / "out"))

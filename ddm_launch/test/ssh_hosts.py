# Two ssh hosts for a test: an sshd of its own on this machine, known under two names.
# SPDX-License-Identifier: BSD-3-Clause
import os
import socket
import subprocess

from processes import Process, free_port
from sweeps import wait_for

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
PRIVILEGE_SEPARATION = "/run/sshd"  # sshd started by root wants it; a boot makes it, a bare system has none


class SshHosts:
    """The hosts `first` and `second`, for ssh called as `ssh_command` says."""

    def __init__(self, folder):
        self.folder = folder
        self.port = free_port()
        self.ssh_command = "ssh -F %s/ssh_config" % folder
        self._made_folder = os.getuid() == 0 and not os.path.isdir(PRIVILEGE_SEPARATION)
        if self._made_folder:
            os.mkdir(PRIVILEGE_SEPARATION, 0o755)
        # Where /sys is missing (a bare chroot) lscpu complains, and GNU parallel takes that for a fault of its own.
        # Without an answer from lscpu it counts the cores in /proc.
        os.mkdir(os.path.join(folder, "bin"))
        with open(os.path.join(folder, "bin", "lscpu"), "w") as stream:
            stream.write("#!/bin/sh\nexit 1\n")
        os.chmod(os.path.join(folder, "bin", "lscpu"), 0o755)
        for name in ("host_key", "user_key"):
            subprocess.check_call(["ssh-keygen", "-q", "-t", "ed25519", "-N", "", "-f", os.path.join(folder, name)])
        for name, text in (("sshd_config", SSHD_CONFIG), ("ssh_config", SSH_CONFIG)):
            with open(os.path.join(folder, name), "w") as stream:
                stream.write(text.format(folder=folder, port=self.port))
        # falls with this process even if it is killed
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
        if self._made_folder:
            os.rmdir(PRIVILEGE_SEPARATION)

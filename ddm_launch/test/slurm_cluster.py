# A Slurm cluster for tests: munged, slurmctld and slurmd run on this machine, with all files in one folder.
# SPDX-License-Identifier: BSD-3-Clause
import getpass
import os
import subprocess

from processes import Process, free_port
from sweeps import wait_for

# The cluster needs no root, cgroup or systemd. slurmd can load the plugin for cgroups v1 without using cgroups.
SLURM_CONF = """\
ClusterName=test
SlurmctldHost=localhost
SlurmctldPort={controller_port}
SlurmdPort={daemon_port}
SlurmUser={user}
SlurmdUser={user}
AuthType=auth/munge
AuthInfo=socket={folder}/munge.socket
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
MpiDefault=none
SwitchType=switch/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SchedulerType=sched/builtin
SchedulerParameters=sched_interval=1,batch_sched_delay=0
SlurmdParameters=config_overrides
ReturnToService=2
KillWait=5
MaxArraySize=1001
NodeName=localhost NodeAddr=127.0.0.1 CPUs=2
PartitionName=all Nodes=localhost Default=YES
"""
CGROUP_CONF = """\
{plugin}
CgroupMountpoint={folder}/no_cgroup
"""


def cgroup_plugin():
    """The line of cgroup.conf that selects the plugin; empty for versions before 22.05, which do not support the
    line (Debian 11 has 20.11)."""
    version = subprocess.check_output(["/usr/sbin/slurmd", "-V"], universal_newlines=True)
    return "CgroupPlugin=cgroup/v1" if int(version.split()[-1].split(".")[0]) >= 22 else ""


class SlurmCluster:
    """Two CPUs of this machine. Slurm commands find the cluster through `environment`."""

    def __init__(self, folder):
        """folder: an empty folder with an absolute path without spaces."""
        self.folder = folder
        self.environment = {"SLURM_CONF": os.path.join(folder, "slurm.conf")}
        self._daemons = []
        values = {"folder": folder, "user": getpass.getuser(), "controller_port": free_port(),
                  "daemon_port": free_port(), "plugin": cgroup_plugin()}
        for name, text in (("slurm.conf", SLURM_CONF), ("cgroup.conf", CGROUP_CONF)):
            with open(os.path.join(folder, name), "w") as stream:
                stream.write(text.format(**values))
        for name in ("state", "spool"):
            os.mkdir(os.path.join(folder, name))
        try:
            self._start()
        except BaseException:
            self.stop()
            raise

    def _start(self):
        key = os.path.join(self.folder, "munge.key")
        with open(os.open(key, os.O_WRONLY | os.O_CREAT, 0o600), "wb") as stream:
            stream.write(os.urandom(1024))
        socket = os.path.join(self.folder, "munge.socket")
        # --force: other users may have write access to a parent folder of the test's folder
        self._daemon("munged", "--foreground", "--force", "--socket", socket, "--key-file", key, "--origin",
                     "127.0.0.1", *("--%s-file=%s/munged.%s" % (name, self.folder, name)
                                    for name in ("log", "pid", "seed")))
        self._wait(lambda: os.path.exists(socket), "munged")
        self._daemon("slurmctld", "-D", "-c", "-f", self.environment["SLURM_CONF"])
        self._daemon("slurmd", "-D", "-N", "localhost", "-f", self.environment["SLURM_CONF"])
        self._wait(lambda: self.call("sinfo", "--noheader", "--format", "%T").strip() == "idle", "an idle node")

    def _daemon(self, name, *arguments):
        # the daemon ends with this process even if this process is killed
        command = ["setpriv", "--pdeathsig", "KILL", "/usr/sbin/" + name] + list(arguments)
        self._daemons.append(Process(command, dict(os.environ, **self.environment)))

    def _wait(self, condition, what):
        def ready():
            for daemon in self._daemons:
                if not daemon.isRunning():
                    raise AssertionError("a daemon has ended:\n%s" % daemon.output)
            return condition()

        try:
            wait_for(ready, what)
        except AssertionError as error:
            raise AssertionError("%s\n%s" % (error, "\n".join(daemon.output for daemon in self._daemons)))

    def call(self, *command):
        """Returns stdout and stderr of a Slurm command."""
        done = subprocess.run(command, env=dict(os.environ, **self.environment), stdin=subprocess.DEVNULL,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True)
        return done.stdout

    def tasks(self):
        """States of the tasks that have not ended."""
        return self.call("squeue", "--noheader", "--array", "--format", "%T").split()

    def stop(self):
        """Ends all jobs, then the daemons."""
        if len(self._daemons) == 3 and all(daemon.isRunning() for daemon in self._daemons):
            self.call("scancel", "--user", getpass.getuser())
            wait_for(lambda: not self.tasks(), "the end of all jobs")
        for daemon in reversed(self._daemons):
            daemon.stop()

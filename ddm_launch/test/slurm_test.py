# Sweeps as Slurm job arrays: on a cluster on this machine, and with unusual answers of sbatch, squeue and scancel.
# SPDX-License-Identifier: BSD-3-Clause
import os
import re
import signal

import pytest

from ddm_launch.slurm import index_ranges
from processes import run_experiment
from run_files import differences, expected_files, files_in, read_bytes
from slurm_cluster import SlurmCluster
from sweeps import (Sweep, assert_ends, assert_nothing_runs, assert_table, debug, is_finished, processes_with, programs_of,
                    seed_folder, snapshot, wait_for)

QUEUED = "echo CLUSTER: west; echo ddm_task PENDING; echo ddm_task RUNNING"
UNREACHABLE = "echo slurm_load_jobs error: Unable to contact slurm controller >&2; exit 1"


@pytest.fixture(name="cluster", scope="module")
def make_cluster(tmp_path_factory):
    folder = str(tmp_path_factory.mktemp("cluster"))
    cluster = SlurmCluster(folder)
    yield cluster
    cluster.stop()
    wait_for(lambda: not processes_with([folder]), "the end of all daemons", 10.0)


def job_of(output):
    return re.search(r"Submitted batch job (\d+)", output).group(1)


def test_seeds_are_the_tasks_of_a_job_array_and_gnu_parallel_goes_on_where_slurm_ended(cluster, tmp_path):
    out = str(tmp_path / "out")
    output = assert_ends(0, ["3 of 3 seeds finished", "seed 2 finished ("], *debug(out, "0:3"), "--slurm",
                         environment=cluster.environment)
    jobs = cluster.call("scontrol", "show", "job", job_of(output))
    for seed in range(3):
        assert "ArrayTaskId=%d " % seed in jobs
        log = read_bytes(out, "logs", "seed_%04d.log" % seed).decode()
        assert "task %s_%d of Slurm" % (job_of(output), seed) in log
    assert jobs.count("JobState=COMPLETED") == 3
    assert [name for name in files_in(out) if not name.startswith(("seed_", "logs/"))] == ["run_seed.sh", "sweep.csv", "sweep.yaml"]
    single = str(tmp_path / "single")
    run_experiment("--preset", "debug", "--seed", 2, "--trials", 1, "--out", single)
    assert differences(single, seed_folder(out, 2), expected_files(1)) == []
    assert_ends(0, ["1 of 4 seeds to run"], *debug(out, "0:4"))
    output = assert_ends(0, ["1 of 5 seeds to run"], *debug(out, "0:5"), "--slurm", environment=cluster.environment)
    assert "ArrayTaskId=4 " in cluster.call("scontrol", "show", "job", job_of(output))
    assert_table(out, range(5))


def test_the_job_of_a_killed_sweep_goes_on_and_is_waited_for_and_a_cancelled_task_is_named(cluster, tmp_path):
    out, words = str(tmp_path / "out"), (*debug(str(tmp_path / "out"), "0:3", 12), "--slurm", "--jobs", 1)
    with Sweep(*words, environment=cluster.environment) as process:
        wait_for(lambda: is_finished(out, 0) and programs_of(seed_folder(out, 1)), "the middle of the sweep")
        process.kill_group()
    job, before = job_of(process.output), snapshot(seed_folder(out, 0))
    cluster.call("scancel", job + "_2")
    output = assert_ends(0, ["1 of 3 seeds to run", "3 of 3 seeds finished"], *words,
                         environment=cluster.environment)
    assert "CANCELLED" not in output and snapshot(seed_folder(out, 0)) == before
    assert "JobState=COMPLETED" in cluster.call("scontrol", "show", "job", job + "_1")
    assert_table(out, range(3), 12)


def test_ctrl_c_cancels_the_job_and_what_sbatch_refuses_is_told_with_its_words(cluster, tmp_path):
    out = str(tmp_path / "out")
    with Sweep(*debug(out, "0:2", 999), "--slurm", environment=cluster.environment) as process:
        wait_for(lambda: programs_of(seed_folder(out, 0)), "the program of seed 0")
        process.send_signal(signal.SIGINT)
        assert process.waitForEnd(30.0) == 130, process.output
    assert "slurm_job" not in files_in(out)
    wait_for(lambda: not cluster.tasks(), "the end of all tasks")
    assert_nothing_runs(out)
    assert_ends(1, ["job array 0-1", "nonsense", "SBATCH_PARTITION"], *debug(out, "0:2", 999), "--slurm",
                environment=dict(cluster.environment, SBATCH_PARTITION="nonsense"))
    assert_ends(1, ["job array 1001", "MaxArraySize"], *debug(out, "1001:1002", 999), "--slurm", environment=cluster.environment)


class Site:
    """A cluster whose commands give prepared answers and whose tasks compute nothing."""

    def __init__(self, folder):
        self.folder, self.out, self.started = folder, str(folder / "out"), []
        (folder / "bin").mkdir()
        self.answer("sbatch", "echo Welcome; echo Submitted batch job 4711")
        self.answer("squeue", QUEUED)
        self.answer("scancel", "true")

    def answer(self, name, script):
        """Makes a command run this script from now on. The file is replaced as a whole, because a shell may be
        reading it."""
        (self.folder / "new").write_text(script + "\n")
        (self.folder / "new").rename(self.folder / (name + "_answer"))
        path = self.folder / "bin" / name
        path.write_text("#!/bin/bash\necho \"%s $*\" >> '%s'\n. '%s'\n" % (
            name, self.folder / "calls", self.folder / (name + "_answer")))
        path.chmod(0o755)

    def calls(self, name):
        """The arguments of each call of a command."""
        lines = (self.folder / "calls").read_text().splitlines() if (self.folder / "calls").exists() else []
        return [line[len(name) + 1:] for line in lines if line.startswith(name + " ")]

    def start(self, seeds="0:2", engine=("--slurm",)):
        self.started.append(Sweep(*debug(self.out, seeds, 0), *engine,
                                  environment={"PATH": "%s:%s" % (self.folder / "bin", os.environ["PATH"])}))
        return self.started[-1]

    def start_and_watch(self):
        """Starts a sweep and waits until it has asked for the state of its job."""
        before, process = len(self.calls("squeue")), self.start()
        wait_for(lambda: len(self.calls("squeue")) > before, "the first squeue")
        return process

    def wait_for_questions(self, count):
        asked = len(self.calls("squeue"))
        wait_for(lambda: len(self.calls("squeue")) > asked + count, "more questions")


@pytest.fixture(name="site")
def make_site(tmp_path):
    before = signal.signal(signal.SIGHUP, signal.SIG_DFL)  # undoes the effect of nohup
    site = Site(tmp_path)
    yield site
    for process in site.started:
        process.stop()
    signal.signal(signal.SIGHUP, before)


def assert_end(process, code, *words):
    assert process.waitForEnd(30.0) == code, process.output
    assert all(word in process.output for word in words) and "not started" not in process.output, process.output


def test_a_job_outlives_its_sweep_and_its_cluster_is_asked_and_told_to_cancel_it(site, monkeypatch):
    monkeypatch.setenv("SBATCH_CLUSTERS", "west")
    monkeypatch.setenv("SQUEUE_STATES", "SUSPENDED")  # would hide tasks
    site.answer("squeue", "[[ $SLURM_CLUSTERS == west && -z ${SQUEUE_STATES:-} ]] && %s" % QUEUED)
    for number in (signal.SIGHUP, signal.SIGTERM, signal.SIGKILL):
        process = site.start_and_watch()
        process.send_signal(number)
        assert_end(process, *([-number] if number == signal.SIGKILL else [
            128 + number, "the Slurm job ddm_sweep_", "may be running", "same command waits for it", "'scancel --name ddm_sweep_"]))
    # by GNU parallel
    assert_end(site.start(engine=()), 1, "may be running", site.out + "/slurm_job")
    process = site.start_and_watch()
    process.send_signal(signal.SIGINT)
    assert_end(process, 130)
    cancelled, = site.calls("scancel")
    assert cancelled in site.calls("squeue")[-1] and len(site.calls("sbatch")) == 1
    assert "slurm_job" not in files_in(site.out)


@pytest.mark.parametrize("answer, told", [
    (UNREACHABLE, True), ("sleep 0.1; exit 3", True), ("echo squeue: error: busy >&2", True), (QUEUED, False)])
def test_a_job_that_may_be_running_is_waited_for(answer, told, site):
    site.answer("squeue", answer)
    process = site.start_and_watch()
    site.wait_for_questions(2)
    assert process.isRunning() and ("waiting for Slurm" in process.output) == told
    site.answer("squeue", "echo NOTICE; echo MAINTENANCE")
    assert_end(process, 1, "0 of 2 seeds finished")


@pytest.mark.parametrize("reply, said", [
    ("kill -9 $$", "said nothing"), ("echo 'sbatch: error: Socket timed out' >&2; exit 1", "Socket timed out")])
def test_a_job_that_sbatch_does_not_confirm_is_waited_for_by_the_same_command(reply, said, site):
    site.answer("sbatch", reply)
    assert_end(site.start(), 1, "same command waits for it", said)
    site.start_and_watch()
    assert len(site.calls("sbatch")) == 1


def test_indices_are_written_as_ranges():
    for seeds, text in (([3], "3"), ([0, 1, 2, 5], "0-2,5"), ([0, 2, 3, 7, 8], "0,2-3,7-8")):
        assert index_ranges(seeds) == text

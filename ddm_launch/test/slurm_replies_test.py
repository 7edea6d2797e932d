# Sweeps on clusters whose commands answer in other ways than the one of slurm_test.
# SPDX-License-Identifier: BSD-3-Clause
import os
import signal

from run_files import files_in, read_bytes
from scratch_case import ScratchCase
from sweeps import Sweep, wait_for

QUEUED = "echo PENDING; echo RUNNING"
FORGOTTEN = "echo slurm_load_jobs error: Invalid job id specified >&2; exit 1"
UNREACHABLE = "echo slurm_load_jobs error: Unable to contact slurm controller >&2; exit 1"


class SlurmRepliesTest(ScratchCase):
    def setUp(self):
        super().setUp()
        self.addCleanup(signal.signal, signal.SIGHUP, signal.signal(signal.SIGHUP, signal.SIG_DFL))  # not under nohup
        os.mkdir(self.file("bin"))
        self.answer("sbatch", "echo 4711")
        self.answer("squeue", QUEUED)
        self.answer("scancel", "echo '%s' > '%s'" % (FORGOTTEN, self.file("squeue_answer")))

    def answer(self, name, script):
        """From now on the command runs this script, which never changes under a shell that reads it."""
        new = self.write("new", script + "\n")
        os.replace(new, self.file(name + "_answer"))
        path = self.write("bin/" + name, "#!/bin/bash\necho \"%s $*\" >> '%s'\n. '%s'\n" % (
            name, self.file("calls"), self.file(name + "_answer")))
        os.chmod(path, 0o755)

    def calls(self, name):
        """The arguments of each call of a command."""
        if not os.path.exists(self.file("calls")):
            return []
        lines = read_bytes(self.file("calls")).decode().splitlines()
        return [line[len(name) + 1:] for line in lines if line.startswith(name + " ")]

    def start(self, seeds="0:2", engine=("--slurm",)):
        process = Sweep("--preset", "debug", "--seeds", seeds, "--trials", 0, "--out", self.out, *engine,
                        environment={"PATH": self.file("bin") + ":" + os.environ["PATH"]})
        self.addCleanup(process.stop)
        return process

    def startAndWatch(self, *arguments, **kwargs):
        """A sweep that has asked for the state of its job."""
        before = len(self.calls("squeue"))
        process = self.start(*arguments, **kwargs)
        wait_for(lambda: len(self.calls("squeue")) > before, "the first squeue")
        return process

    def assertEnds(self, code, process, words):
        self.assertEqual(process.waitForEnd(30.0), code, process.output)
        for word in words:
            self.assertIn(word, process.output)
        self.assertNotIn("not started", process.output)

    def test_the_number_is_found_among_the_lines_of_a_site(self):
        for reply in ("Welcome\\n--> 2 allocations: ok\\n4711\\n", "4711\\nPlease acknowledge us in 2026\\n",
                      "sbatch: warning\\n 4711\\r\\n\\n", "12\\n4711\\n",
                      "4711\\nYour quota [h]:\\n37\\n", "Your job:\\n4711\\n"):
            self.answer("sbatch", "echo a warning >&2; printf '%s'" % reply)
            self.answer("squeue", QUEUED)
            process = self.startAndWatch()
            process.send(signal.SIGINT)
            self.assertEnds(130, process, ["Slurm job 4711\n", "SIGINT"])
            self.assertIn("--jobs 4711 ", self.calls("squeue")[-1])
            self.assertEqual(self.calls("scancel")[-1], "4711")
            self.assertNotIn("slurm_job", files_in(self.out))

    def test_the_cluster_of_the_job_is_asked_and_told_to_cancel_it(self):
        self.answer("sbatch", "echo '4711;west'")
        self.answer("squeue", "[[ $* = '-M west '* ]] || { %s; }\necho CLUSTER: west; %s" % (FORGOTTEN, QUEUED))
        process = self.startAndWatch()
        process.send(signal.SIGHUP)
        self.assertEnds(129, process, ["Slurm job 4711 of cluster west may be running", "'scancel -M west 4711' cancels"])
        process = self.startAndWatch()
        process.send(signal.SIGINT)
        self.assertEnds(130, process, [])
        self.assertEqual(self.calls("scancel"), ["-M west 4711"])

    def test_a_job_outlives_its_sweep_and_the_same_command_waits_for_it(self):
        for number in (signal.SIGHUP, signal.SIGTERM, signal.SIGKILL):
            process = self.startAndWatch()
            process.send(number)
            self.assertEnds(-number if number == signal.SIGKILL else 128 + number, process,
                            [] if number == signal.SIGKILL else ["4711 may be running", "same command waits for it"])
        process = self.startAndWatch("0:4")
        self.assertEqual(len(self.calls("sbatch")), 1)
        self.answer("squeue", FORGOTTEN)
        self.answer("sbatch", "echo 4712")
        self.assertEnds(1, process, ["Slurm job 4711\n", "2 of 4 seeds to run", "Slurm job 4712\n", "seed 0: ", "seed 3: "])
        self.assertIn("--array 2-3 ", self.calls("sbatch")[1])
        self.assertEqual(self.calls("scancel"), [])
        self.assertNotIn("slurm_job", files_in(self.out))

    def test_a_job_of_unknown_state_is_waited_for(self):
        for silence in (UNREACHABLE, "sleep 0.1; exit 3", "echo squeue: error: busy >&2"):
            self.answer("squeue", silence)
            process = self.startAndWatch()
            process.waitForText("waiting for Slurm", 30.0)
            asked = len(self.calls("squeue"))
            wait_for(lambda: len(self.calls("squeue")) > asked + 1, "more questions")
            self.assertTrue(process.isRunning())
            self.answer("squeue", "echo NOTICE; echo MAINTENANCE; echo COMPLETED; echo CANCELLED")
            self.assertEnds(1, process, ["0 of 2 seeds finished"])

    def test_a_job_without_a_number_may_be_running(self):
        replies = [("echo Welcome", "Welcome"), ("kill -9 $$", "said nothing"), ("echo 4711; exit 1", "4711")]
        for lost in ("Socket timed out on send/recv operation", "Zero Bytes were transmitted or received",
                     "Unexpected message received", "Connection reset by peer", "Message receive failure",
                     "Transport endpoint is not connected"):
            replies.append(("echo 'sbatch: error: Batch job submission failed: %s' >&2; exit 1" % lost, lost))
        for reply, said in replies:
            self.answer("sbatch", reply)
            self.assertEnds(1, self.start(), ["may be running", "squeue --me", said])

    def test_a_task_that_lost_its_node_may_be_queued_again(self):
        process = self.startAndWatch()
        self.answer("squeue", "echo PREEMPTED; echo NODE_FAIL")
        asked = len(self.calls("squeue"))
        wait_for(lambda: len(self.calls("squeue")) > asked + 2, "more questions")
        self.assertTrue(process.isRunning())
        self.answer("squeue", FORGOTTEN)
        self.assertEnds(1, process, ["0 of 2 seeds finished"])

    def test_another_engine_is_refused_while_a_job_may_be_running(self):
        process = self.startAndWatch()
        process.send(signal.SIGTERM)
        process.waitForEnd(30.0)
        self.assertEnds(1, self.start(engine=()), ["4711 may be running", "scancel 4711", self.out + "/slurm_job"])

# Runs an experiment with a fault, then the same command without one, and tells what came of it.
# SPDX-License-Identifier: BSD-3-Clause
import contextlib
import os
import re
import shutil
import subprocess

from ddm_launch.faults.damage import damage
from ddm_launch.processes import start_roslaunch
from ddm_launch.run_comparison import differences, expected_files, files_in, read_bytes
from ddm_launch.run_folder import is_finished, num_finished
from ddm_launch.step_runner import Failure

SEED, TRIALS = 1, 1
LIMIT_S = 120.0  # of a launch
# Long trainings, so that there is time for a fault; short limits, so that a silent node is named soon.
CONFIG = """\
training: {{max_iterations: 3000, function_tolerance: 1.0e-12}}
sim: {{watchdog: {node_s}}}
controller: {{timeout: {node_s}}}
recorder: {{timeout: {node_s}}}
experiment: {{timeout: {experiment_s}}}
"""
REAL_TIME_CONFIG = "plant: {dt: 0.05}\n"  # shorter waits than with the paper's 0.2 s
NODE_S, EXPERIMENT_S = 5.0, 8.0  # without a sign of life
CRASH = re.compile(r"exit code -(?!2\b|9\b|15\b)\d+|Traceback|terminate called|Segmentation fault")
DISK_BYTES = 2 * 1024 * 1024
COMPARED = [name for name in expected_files(TRIALS) if not name.endswith((".bag", "config.yaml"))]


def is_real_time(case):
    return case.phase.endswith("in real time")


def files_of_trials(folder, count):
    """{name: content} of what the first trials have left."""
    folders = tuple("%s_%03d/" % (kind, k) for kind in ("trial", "evaluation") for k in range(count))
    return {name: read_bytes(folder, name) for name in files_in(folder) if name.startswith(folders)}


@contextlib.contextmanager
def small_disk(folder):
    """A file system of its own for a folder, which can be full or read-only. Needs root."""
    os.makedirs(folder)
    subprocess.run(["mount", "-t", "tmpfs", "-o", "size=%d" % DISK_BYTES, "none", folder], check=True)
    try:
        yield
    finally:
        subprocess.run(["umount", "--lazy", folder], check=True)


class FaultBench:
    """Runs cases in folders of their own under `out`:

      reference/, begun/   the undisturbed experiment, and how it was when its first trial was finished
      CASE/run             the experiment of a case; CASE/ros: logs of its nodes
      logs/CASE.txt        what its launches said
    """

    def __init__(self, out, patience=1.0):
        """patience: what all time limits are multiplied by."""
        self.out, self.limit_s = out, LIMIT_S * patience
        self.config, self.real_time_config = (os.path.join(out, name) for name in ("config.yaml", "real_time.yaml"))
        self.reference, self.begun = os.path.join(out, "reference", "run"), os.path.join(out, "begun")
        self.launches = []
        os.makedirs(os.path.join(out, "logs"), exist_ok=True)
        config = CONFIG.format(node_s=NODE_S * patience, experiment_s=EXPERIMENT_S * patience)
        for path, text in ((self.config, config), (self.real_time_config, config + REAL_TIME_CONFIG)):
            with open(path, "w") as stream:
                stream.write(text)

    def make_reference(self):
        """Raises Failure if even the undisturbed experiment does not finish."""
        for folder in (os.path.dirname(self.reference), self.begun):
            shutil.rmtree(folder, ignore_errors=True)
        output = self.launch(self.reference, "experiment.launch", self.experiment(self.reference))
        if not is_finished(self.reference):
            raise Failure("the undisturbed experiment did not finish:\n%s" % output[-2000:])
        shutil.copytree(self.reference, self.begun)
        os.remove(os.path.join(self.begun, "summary.yaml"))
        for name in ("trial_001", "evaluation_001"):
            shutil.rmtree(os.path.join(self.begun, name))
        rows = read_bytes(self.begun, "trials.csv").splitlines(keepends=True)
        with open(os.path.join(self.begun, "trials.csv"), "wb") as stream:
            stream.writelines(rows[:2])

    def experiment(self, folder, real_time=False):
        return ["preset:=debug", "seed:=%d" % SEED, "trials:=%d" % TRIALS, "runs:=" + folder,
                "config:=" + (self.real_time_config if real_time else self.config),
                "real_time:=%s" % str(real_time).lower()]

    def launch(self, folder, launch_file, arguments):
        """Runs a launch to its end. Returns its output; raises TimeoutError if it does not end."""
        launch = start_roslaunch(os.path.join(os.path.dirname(folder), "ros"), launch_file, *arguments,
                                 options=["--sigint-timeout=5", "--sigterm-timeout=2"])
        self.launches.append(launch)
        try:
            launch.waitForEnd(self.limit_s)
        finally:
            self.launches.remove(launch)
        return launch.output

    def stop(self):
        """Ends what runs."""
        for launch in list(self.launches):
            launch.stop()

    def run(self, case):
        """Returns what was observed, in the words of the case's expected outcome."""
        folder = os.path.join(self.out, case.name.replace(" ", "_"), "run")
        shutil.rmtree(os.path.dirname(folder), ignore_errors=True)
        log = os.path.join(self.out, "logs", case.name.replace(" ", "_") + ".txt")
        with open(log, "w") as stream, contextlib.ExitStack() as stack:
            if case.root:
                stack.enter_context(small_disk(folder))
            facts = self.facts(case, folder, stream)
        observed = ", ".join(facts)
        if observed == case.expected:
            shutil.rmtree(os.path.dirname(folder))
        return observed

    def facts(self, case, folder, log):
        try:
            output, mend = self.disturb(case, folder)
        except TimeoutError as error:
            log.write(str(error))
            return ["hung"]
        log.write(output)
        if output.startswith("not injected"):
            return ["not injected"]
        facts = ["finished" if is_finished(folder) else "ended"]
        if CRASH.search(output):
            facts.append("crashed")
        missing = [word for word in case.words if word not in output]
        if case.words:
            facts.append("not named: " + " | ".join(missing) if missing else "named")
        if is_real_time(case):
            facts += re.findall("^motor: (.*)$", output, re.MULTILINE) or ["the motor was not watched"]
        if "undamaged" in case.expected:
            facts += self.resume(case, folder, mend, log)
        if "equal" in case.expected:
            found = differences(self.reference, folder, COMPARED) if is_finished(folder) else ["no verdict"]
            facts.append("differs: " + " ".join(found) if found else "equal")
        return facts

    def disturb(self, case, folder):
        """Returns what the disturbed launch said, and a function that takes away what still disturbs."""
        report = os.path.join(os.path.dirname(folder), "report.txt")
        if case.phase == "at rest":
            return self.disturb_at_rest(case, folder)
        arguments = self.experiment(folder, is_real_time(case)) + [
            "phase:=" + case.phase, "fault:=" + case.fault, "report:=" + report]
        output = self.launch(folder, "fault.launch", arguments)
        if not os.path.exists(report):
            return "not injected: the phase did not come\n" + output, None
        with open(report) as stream:
            said = stream.read()
        filler = os.path.join(folder, "filler")
        return output + said, lambda: os.path.exists(filler) and os.remove(filler)

    def disturb_at_rest(self, case, folder):
        shutil.copytree(self.begun, folder, dirs_exist_ok=True)
        if case.fault == "read-only folder":
            subprocess.run(["mount", "-o", "remount,ro", folder], check=True)
            output = self.launch(self.reference, "experiment.launch", self.experiment(folder))
            return output, lambda: subprocess.run(["mount", "-o", "remount,rw", folder], check=True)
        path, content = damage(case.fault, folder)
        if path.endswith("model.ddm"):
            return self.launch(folder, "control.launch", ["preset:=debug", "model:=" + path]), None
        output = self.launch(folder, "experiment.launch", self.experiment(folder))

        def mend():
            with open(path, "wb") as stream:
                stream.write(content)
        return output, mend

    def resume(self, case, folder, mend, log):
        count = num_finished(folder)
        mend()
        before = files_of_trials(folder, count)
        log.write("\n--- the same command again ---\n")
        try:
            log.write(self.launch(folder, "experiment.launch", self.experiment(folder, is_real_time(case))))
        except TimeoutError as error:
            log.write(str(error))
        after = files_of_trials(folder, count)
        damaged = [name for name in before if before[name] != after.get(name)]
        # A trial that had been finished before the fault is as the undisturbed experiment has it. In real time no two
        # experiments are equal.
        wrong = [] if is_real_time(case) else differences(self.reference, folder,
                                                          [name for name in COMPARED if name in before])
        return ["damaged: " + " ".join(sorted(set(damaged + wrong))) if damaged + wrong else "undamaged",
                "resumes" if is_finished(folder) else "does not resume"]

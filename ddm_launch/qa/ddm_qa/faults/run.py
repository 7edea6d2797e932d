# Runs an experiment with a fault, then the same command without one, and tells what came of it.
# SPDX-License-Identifier: BSD-3-Clause
import contextlib
import json
import os
import re
import shutil
import subprocess
import traceback

import rosbag

from ddm_launch.command import Failure
from ddm_launch.run_folder import is_finished
from ddm_model.plain_file import write_file
from ddm_qa.faults import at_rest
from ddm_qa.faults.cases import AT_REST, ON_A_ROBOT, REAL_TIME
from ddm_qa.faults.watches import learned
from ddm_qa.processes import start_roslaunch
from ddm_qa.run_comparison import Finished, differences, expected_files, read_bytes, read_rows

SEED, TRIALS = 1, 1
NO_FAULT = "none"
FAULT_LAUNCH = "fault.launch"
LIMIT_S = 120.0  # of a launch
# Long trainings, so that there is time for a fault; short limits, so that a silent node is named soon.
# Trainings last half a second, so that faults reach them even on fast processors. The controller waits longer than the simulator,
# which therefore is the one that reports a message lost between them.
CONFIG = """\
training: {{max_iterations: 15000, function_tolerance: 0.0}}
sim: {{watchdog: {node_s}}}
controller: {{timeout: {controller_s}}}
recorder: {{timeout: {node_s}}}
experiment: {{timeout: {experiment_s}}}
"""
REAL_TIME_DT_S = 0.05  # shorter waits than with the paper's 0.2 s
REAL_TIME_CONFIG = "plant: {dt: %g}\n" % REAL_TIME_DT_S
ROBOT_CONFIG = "robot: {position_limits: [[-1000.0, 1000.0]], speed_limit: [1000.0]}\n"
LONG_PLANS = "mpc: {horizon: 200, num_starts: 1000, max_iterations: 1000000, function_tolerance: 0.0, time_budget: %g}\n"
CONFIGS = {"long plans": LONG_PLANS % 0.0, "long plans with a budget": LONG_PLANS % 0.02}  # by fault
NODE_S, CONTROLLER_S, EXPERIMENT_S = 5.0, 8.0, 11.0  # without a sign of life
CRASH = re.compile(r"exit code -(?!2\b|9\b|15\b)\d+|Traceback|terminate called|Segmentation fault")
DISK_BYTES = 2 * 1024 * 1024
COMPARED = [name for name in expected_files(TRIALS) if not name.endswith((".bag", "config.yaml"))]


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

    seed = SEED

    def __init__(self, out, patience=1.0):
        """patience: what all time limits are multiplied by, but a robot's: its motors must stop in time anywhere."""
        self.out, self.limit_s = out, LIMIT_S * patience
        self.config = CONFIG.format(node_s=NODE_S * patience, controller_s=CONTROLLER_S * patience,
                                    experiment_s=EXPERIMENT_S * patience)
        self.reference, self.begun = os.path.join(out, "reference", "run"), os.path.join(out, "begun")
        self.launches = []
        os.makedirs(os.path.join(out, "logs"), exist_ok=True)

    def make_reference(self):
        """Raises Failure if even the undisturbed experiment does not finish."""
        for folder in (os.path.dirname(self.reference), self.begun):
            shutil.rmtree(folder, ignore_errors=True)
        output = self.launch_experiment(self.reference, self.reference)
        if not is_finished(self.reference):
            raise Failure("the undisturbed experiment did not finish:\n%s" % output[-2000:])
        shutil.copytree(self.reference, self.begun)
        os.remove(os.path.join(self.begun, "summary.yaml"))
        for name in ("trial_001", "evaluation_001"):
            shutil.rmtree(os.path.join(self.begun, name))
        rows = read_bytes(self.begun, "trials.csv").splitlines(keepends=True)
        with open(os.path.join(self.begun, "trials.csv"), "wb") as stream:
            stream.writelines(rows[:2])

    def launch_experiment(self, beside, folder, seed=SEED, launch_file="experiment.launch", config="", **more):
        """Without a fault, in lock-step, unless `more` arguments say otherwise. beside: the logs of its nodes go next to
        this folder. config: more of it."""
        path = os.path.join(os.path.dirname(beside), "config.yaml")
        os.makedirs(os.path.dirname(path), exist_ok=True)
        write_file(path, self.config + config)  # whole, since several cases may read it
        values = dict({"preset": "debug", "seed": seed, "trials": TRIALS, "runs": folder, "config": path}, **more)
        return self.launch(beside, launch_file, ["%s:=%s" % item for item in values.items()])

    def launch_case(self, case, folder, fault=NO_FAULT):
        """Runs the experiment of a case, with a fault if there is one."""
        injection = {"phase": case.phase, "fault": fault, "report": self.report(folder)}
        if case.phase.endswith(ON_A_ROBOT):
            return self.launch_experiment(folder, folder, launch_file=FAULT_LAUNCH, config=ROBOT_CONFIG, robot="true",
                                          **injection)
        real_time = case.phase.endswith(REAL_TIME)
        config, mode = REAL_TIME_CONFIG if real_time else "", {"real_time": "true" if real_time else "false"}
        if fault in CONFIGS or fault == NO_FAULT:
            return self.launch_experiment(folder, folder, config=config + CONFIGS.get(fault, ""), **mode)
        return self.launch_experiment(folder, folder, launch_file=FAULT_LAUNCH, config=config, **mode, **injection)

    @staticmethod
    def report(folder):
        return os.path.join(os.path.dirname(folder), "report.json")

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
            if case.phase == AT_REST:
                return at_rest.facts(self, case, folder, log)
            return self.disturb(case, folder, log)
        except TimeoutError as error:
            log.write(str(error))
            return ["hung"]
        except (OSError, ValueError, IndexError, KeyError, rosbag.ROSBagException) as error:  # of files that it has left
            log.write(traceback.format_exc())
            return ["unreadable: %s" % error]

    @staticmethod
    def verdict(folder):
        return "finished" if is_finished(folder) else "ended"

    @staticmethod
    def words(case, output):
        facts = ["crashed"] if CRASH.search(output) else []
        missing = [word for word in case.words if word not in output]
        if case.words:
            facts.append("not named: " + " | ".join(missing) if missing else "named")
        return facts

    def compared(self, folder):
        found = differences(self.reference, folder, COMPARED) if is_finished(folder) else ["no verdict"]
        return "differs: " + " ".join(found) if found else "equal"

    def disturb(self, case, folder, log):
        output = self.launch_case(case, folder, case.fault)
        log.write(output)
        if case.fault in CONFIGS:
            return [self.verdict(folder)] + self.words(case, output) + (
                [self.speed(folder)] if "in time" in case.expected and is_finished(folder) else [])
        if not os.path.exists(self.report(folder)):
            return ["not injected"]
        report = json.loads(read_bytes(self.report(folder)))
        log.write(report["said"])
        facts = [self.verdict(folder)] + self.words(case, output + report["said"])
        if case.phase.endswith((REAL_TIME, ON_A_ROBOT)):
            facts.append(report.get("motor", "the motor was not watched"))
        if "learned" in case.expected:
            bag = os.path.join(folder, "trial_001", "trial.bag")
            facts.append(learned(bag, report["acted"]) if os.path.exists(bag) else "no bag")
        if "resumes" in case.expected:
            filler = os.path.join(folder, "filler")
            if os.path.exists(filler):
                os.remove(filler)
            facts += self.resume(case, folder, Finished(*report["finished"]), log)
        elif "equal" in case.expected:
            facts.append(self.compared(folder))
        return facts

    @staticmethod
    def speed(folder):
        header, *rows = read_rows(folder, "trials.csv")
        slowest_ms = max(float(row[header.index("plan_ms_median")]) for row in rows)
        return "in time" if slowest_ms < 1e3 * REAL_TIME_DT_S else "plans took %g ms" % slowest_ms

    def resume(self, case, folder, before, log):
        """The same command again. before: what was finished before the fault."""
        damaged = before.lost(folder)
        log.write("\n--- the same command again ---\n")
        log.write(self.launch_case(case, folder))
        facts = []
        if "undamaged" in case.expected:
            damaged += before.lost(folder)
            if not case.phase.endswith((REAL_TIME, ON_A_ROBOT)):  # in which no two experiments are equal
                damaged += differences(self.reference, folder, [name for name in COMPARED if name in before.files])
            facts.append("damaged: " + " ".join(sorted(set(damaged))) if damaged else
                         "undamaged" if before.files else "nothing to compare")
        facts.append("resumes" if is_finished(folder) else "does not resume")
        return facts + ([self.compared(folder)] if "equal" in case.expected else [])

# Runs the experiment of a case with its fault, repeats the same command without the fault, and compares the outcome.
# SPDX-License-Identifier: BSD-3-Clause
import bisect
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
from ddm_qa.fault_cases import FAULT_OF_ROOT, ON_A_ROBOT, REAL_TIME
from ddm_qa.processes import start_roslaunch
from ddm_qa.run_comparison import differences, expected_files, lost_files, read_bytes

SEED, TRIALS = 1, 1
NO_FAULT = "no fault"
LIMIT_S = 120.0  # time limit of a launch
# A training takes at least half a second, so that a fault hits it even on a fast processor. Time limits are short, so
# that a silent node is reported soon. The controller's limit is longer than the simulator's; hence the simulator
# reports a message that is lost between them.
CONFIG = """\
training: {{max_iterations: 15000, function_tolerance: 0.0}}
sim: {{watchdog: {0}}}
controller: {{timeout: {1}}}
experiment: {{timeout: {2}}}
"""
SILENT_S = (5.0, 8.0, 11.0)  # time limits for silent nodes
REAL_TIME_CONFIG = "plant: {dt: 0.05}\n"  # shorter than the paper's 0.2 s, to save time
ROBOT_CONFIG = "robot: {position_limits: [[-1000.0, 1000.0]], speed_limit: [1000.0]}\n"
CRASH = re.compile(r"exit code -(?!2\b|9\b|15\b)\d+|Traceback|terminate called|Segmentation fault")
DISK_BYTES = 2 * 1024 * 1024
COMPARED = [name for name in expected_files(TRIALS) if not name.endswith((".bag", "config.yaml"))]
FEWEST_PAIRS = 5  # smallest number of pairs of image and torque in a bag that allows a verdict


@contextlib.contextmanager
def small_disk(folder):
    """Context that mounts a small file system on a folder, for tests with a full disk. Needs root."""
    os.makedirs(folder)
    subprocess.run(["mount", "-t", "tmpfs", "-o", "size=%d" % DISK_BYTES, "none", folder], check=True)
    try:
        yield
    finally:
        subprocess.run(["umount", "--lazy", folder], check=True)


class FaultBench:
    """Runs cases in separate folders below `out`:

      reference/run   the undisturbed experiment
      CASE/run        the experiment of a case; CASE/ros: logs of its nodes
      logs/CASE.txt   output of the launches of a case
    """

    def __init__(self, out, patience=1.0):
        """patience: factor for all time limits, apart from those of a robot, whose motors must always stop in time."""
        self.out, self.limit_s = out, LIMIT_S * patience
        self.config = CONFIG.format(*(limit * patience for limit in SILENT_S))
        self.reference = os.path.join(out, "reference", "run")
        self.launches = set()  # running launches
        os.makedirs(os.path.join(out, "logs"), exist_ok=True)

    def make_reference(self):
        """Runs the undisturbed experiment. Raises Failure if it does not finish."""
        shutil.rmtree(os.path.dirname(self.reference), ignore_errors=True)
        output = self.launch(self.reference)
        if not is_finished(self.reference):
            raise Failure("the undisturbed experiment did not finish:\n%s" % output[-2000:])

    def launch(self, folder, launch_file="experiment.launch", config="", **more):
        """Runs an experiment to its end, without a fault and in lock-step, unless `more` arguments say otherwise. The logs
        are written next to its folder. config: additional configuration. Returns the output. Raises TimeoutError if the
        launch does not end."""
        beside = os.path.dirname(folder)
        path = os.path.join(beside, "config.yaml")
        os.makedirs(beside, exist_ok=True)
        write_file(path, self.config + config)
        values = dict({"preset": "debug", "seed": SEED, "trials": TRIALS, "runs": folder, "config": path}, **more)
        with start_roslaunch(os.path.join(beside, "ros"), launch_file, *("%s:=%s" % item for item in values.items()),
                             options=["--sigint-timeout=5", "--sigterm-timeout=2"]) as launch:
            self.launches.add(launch)
            launch.waitForEnd(self.limit_s)
        self.launches.discard(launch)
        return launch.output

    def run(self, case):
        """Runs a case and returns the observed outcome, in the same words as the expected outcome."""
        name = case.name.replace(" ", "_")
        folder = os.path.join(self.out, name, "run")
        shutil.rmtree(os.path.dirname(folder), ignore_errors=True)
        with open(os.path.join(self.out, "logs", name + ".txt"), "w") as log, contextlib.ExitStack() as stack:
            if case.fault == FAULT_OF_ROOT:
                stack.enter_context(small_disk(folder))
            try:
                observed = CaseRun(self, case, folder, log).observed()
            except TimeoutError as error:
                log.write(str(error))
                observed = "hung"
            # One of the files that the experiment has left is unreadable.
            except (OSError, ValueError, IndexError, KeyError, rosbag.ROSBagException) as error:
                log.write(traceback.format_exc())
                observed = "unreadable: %s" % error
        if observed == case.expected:
            shutil.rmtree(os.path.dirname(folder))
        return observed


class CaseRun:
    """A running case. Each word of an expected outcome is a method, which returns the same word or a description of the
    deviation."""

    def __init__(self, bench, case, folder, log):
        self.bench, self.case, self.folder, self.log = bench, case, folder, log
        self.report_path, self.resumed = os.path.join(os.path.dirname(folder), "report.json"), False

    def launch(self, fault):
        """Runs the experiment, in which fault_injector injects the fault and reports its observations."""
        phase, arguments, config = self.case.phase, {}, ""
        if fault != NO_FAULT or phase.endswith(ON_A_ROBOT):
            arguments = {"launch_file": "fault.launch", "fault": fault, "report": self.report_path,
                         "phase": phase if fault != NO_FAULT else "never" + ON_A_ROBOT}
        if phase.endswith(ON_A_ROBOT):
            arguments["robot"], config = "true", ROBOT_CONFIG
        if phase.endswith(REAL_TIME):
            arguments["real_time"], config = "true", REAL_TIME_CONFIG
        output = self.bench.launch(self.folder, config=config, **arguments)
        self.log.write(output)
        return output

    def observed(self):
        self.output = self.launch(self.case.fault)
        if not os.path.exists(self.report_path):
            return "not injected"
        self.report = json.loads(read_bytes(self.report_path))
        self.before = self.report["finished"]
        self.log.write(self.report["said"])
        self.output += self.report["said"]
        facts = [getattr(self, word.replace(" ", "_"))() for word in self.case.expected.split(", ")]
        return ", ".join(facts + (["crashed"] if CRASH.search(self.output) else []))

    def finished(self):
        """Whether summary.yaml says that the experiment is finished. `ended`: the launch ended by itself and left no
        verdict."""
        return "finished" if is_finished(self.folder) else "ended"

    ended = finished

    def named(self):
        missing = [word for word in self.case.words if word not in self.output]
        return "not named: " + " | ".join(missing) if missing else "named"

    def undamaged(self):
        """Whether all files that were finished before the fault, at least one trial, still have the same bytes after
        the fault and after resuming."""
        damaged = self.resume() + lost_files(self.before, self.folder)
        if not self.case.phase.endswith((REAL_TIME, ON_A_ROBOT)):  # two such experiments always differ
            damaged += differences(self.bench.reference, self.folder, ["trials.csv"] + [name for name in COMPARED if name in self.before])
        if damaged:
            return "damaged: " + " ".join(sorted(set(damaged)))
        return "undamaged" if self.before else "nothing to compare"

    def resumes(self):
        """Whether the same command finishes the experiment."""
        self.resume()
        return "resumes" if is_finished(self.folder) else "does not resume"

    def resume(self):
        """Removes the fault and runs the same command again; further calls do nothing. Returns the finished files that
        were lost before."""
        if self.resumed:
            return []
        self.resumed = True
        filler = os.path.join(self.folder, "filler")  # of a full disk
        if os.path.exists(filler):
            os.remove(filler)
        lost = lost_files(self.before, self.folder)
        self.log.write("\n--- the same command again ---\n")
        self.launch(NO_FAULT)
        return lost

    def equal(self):
        """Whether all files except bags equal those of the undisturbed experiment, apart from times."""
        found = differences(self.bench.reference, self.folder, COMPARED) if is_finished(self.folder) else ["no verdict"]
        return "differs: " + " ".join(found) if found else "equal"

    def zero(self):
        """Whether no torque acts after the fault. In real time, the two periods after the last torque are excluded."""
        return self.report.get("motor", "the motor was not watched")

    def learned_what_acted(self):
        """Whether each image in the trial's bag has either the torque that acted after it or none, and some images have
        none."""
        acted = self.report["acted"]  # (stamp of an image [ns], torque that acted before it) of each frame, in order
        stamps, images, torques = [stamp for stamp, _ in acted], set(), {}
        with rosbag.Bag(os.path.join(self.folder, "trial_001", "trial.bag")) as bag:
            for topic, message, _ in bag.read_messages(["camera/image_raw", "torque"]):
                if topic == "torque":
                    torques[message.header.stamp.to_nsec()] = message.torque[0]
                else:
                    images.add(message.header.stamp.to_nsec())
        pairs = images & set(torques)
        after = {stamp: bisect.bisect_right(stamps, stamp) for stamp in pairs}
        wrong = [stamp for stamp in pairs if after[stamp] == len(acted) or acted[after[stamp]][1] != torques[stamp]]
        if wrong:
            return "%d of %d pairs have a torque that did not act" % (len(wrong), len(pairs))
        if len(pairs) < FEWEST_PAIRS:
            return "only %d pairs" % len(pairs)
        return "learned what acted" if pairs != images else "no image is without a torque"

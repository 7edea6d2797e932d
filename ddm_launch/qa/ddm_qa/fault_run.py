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
from ddm_qa.fault_cases import AT_REST, FAULTS_OF_ROOT, ON_A_ROBOT, REAL_TIME
from ddm_qa.fault_damage import damage, write
from ddm_qa.processes import start_roslaunch
from ddm_qa.run_comparison import (differences, digest, digests, digests_of_finished, expected_files, lost_files, read_bytes,
                                   read_rows)

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
REAL_TIME_DT_S = 0.05  # shorter than the paper's 0.2 s, to save time
REAL_TIME_CONFIG = "plant: {dt: %g}\n" % REAL_TIME_DT_S
ROBOT_CONFIG = "robot: {position_limits: [[-1000.0, 1000.0]], speed_limit: [1000.0]}\n"
LONG_PLANS = "mpc: {horizon: 200, num_starts: 1000, max_iterations: 1000000, function_tolerance: 0.0, time_budget: %g}\n"
CONFIGS = {"long plans": LONG_PLANS % 0.0, "long plans with a budget": LONG_PLANS % 0.02}  # by fault
CRASH = re.compile(r"exit code -(?!2\b|9\b|15\b)\d+|Traceback|terminate called|Segmentation fault")
DISK_BYTES = 2 * 1024 * 1024
COMPARED = [name for name in expected_files(TRIALS) if not name.endswith((".bag", "config.yaml"))]
FEWEST_PAIRS = 5  # smallest number of pairs of image and torque in a bag that allows a verdict
BAG, UNFINISHED = "new.bag", {"unfinished bag": "new.bag.active", "unfinished trial": "trial_001/trial.bag.active"}


@contextlib.contextmanager
def small_disk(folder):
    """Context that mounts a small file system on a folder, for tests with a full or read-only disk. Needs root."""
    os.makedirs(folder)
    subprocess.run(["mount", "-t", "tmpfs", "-o", "size=%d" % DISK_BYTES, "none", folder], check=True)
    try:
        yield
    finally:
        subprocess.run(["umount", "--lazy", folder], check=True)


class FaultBench:
    """Runs cases in separate folders below `out`:

      reference/, begun/   the undisturbed experiment, and a copy of its state after the first trial
      CASE/run             the experiment of a case; CASE/ros: logs of its nodes
      logs/CASE.txt        output of the launches of a case
    """

    def __init__(self, out, patience=1.0):
        """patience: factor for all time limits, apart from those of a robot, whose motors must always stop in time."""
        self.out, self.limit_s = out, LIMIT_S * patience
        self.config = CONFIG.format(*(limit * patience for limit in SILENT_S))
        self.reference, self.begun = os.path.join(out, "reference", "run"), os.path.join(out, "begun")
        self.launches = set()  # running launches
        os.makedirs(os.path.join(out, "logs"), exist_ok=True)

    def make_reference(self):
        """Runs the undisturbed experiment. Raises Failure if it does not finish."""
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
        write(os.path.join(self.begun, "trials.csv"), b"".join(rows[:2]))

    def launch_experiment(self, beside, folder, launch_file="experiment.launch", config="", **more):
        """Runs an experiment without a fault and in lock-step, unless `more` arguments say otherwise. beside: folder
        next to which the logs are written. config: additional configuration. Returns the output."""
        path = os.path.join(os.path.dirname(beside), "config.yaml")
        os.makedirs(os.path.dirname(path), exist_ok=True)
        write_file(path, self.config + config)  # atomic, because several cases may read the file
        values = dict({"preset": "debug", "seed": SEED, "trials": TRIALS, "runs": folder, "config": path}, **more)
        return self.launch(beside, launch_file, ["%s:=%s" % item for item in values.items()])

    def launch(self, beside, launch_file, arguments):
        """Runs a launch to its end. Returns its output. Raises TimeoutError if the launch does not end."""
        with start_roslaunch(os.path.join(os.path.dirname(beside), "ros"), launch_file, *arguments,
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
            if case.fault in FAULTS_OF_ROOT:
                stack.enter_context(small_disk(folder))
            try:
                observed = (AtRest if case.phase == AT_REST else Live)(self, case, folder, log).observed()
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
        self.resumed, self.report = False, {}

    def launch_and_log(self, fault):
        output = self.launch(fault)
        self.log.write(output)
        return output

    def observed(self):
        self.output = self.disturb()
        if self.report is None:
            return "not injected"
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
        self.undo()
        lost = lost_files(self.before, self.folder)
        self.log.write("\n--- the same command again ---\n")
        self.launch_and_log(NO_FAULT)
        return lost

    def equal(self):
        """Whether all files except bags equal those of the undisturbed experiment, apart from times."""
        found = differences(self.bench.reference, self.folder, COMPARED) if is_finished(self.folder) else ["no verdict"]
        return "differs: " + " ".join(found) if found else "equal"


class Live(CaseRun):
    """A case whose fault comes while the experiment runs. fault_injector injects the fault and reports its
    observations."""

    def launch(self, fault):
        phase, arguments, config = self.case.phase, {}, CONFIGS.get(fault, "")
        if fault not in CONFIGS and (fault != NO_FAULT or phase.endswith(ON_A_ROBOT)):
            arguments = {"launch_file": "fault.launch", "fault": fault, "report": self.report_path,
                         "phase": phase if fault != NO_FAULT else "never" + ON_A_ROBOT}
        if phase.endswith(ON_A_ROBOT):
            arguments["robot"], config = "true", ROBOT_CONFIG
        if phase.endswith(REAL_TIME):
            arguments["real_time"], config = "true", REAL_TIME_CONFIG + config
        return self.bench.launch_experiment(self.folder, self.folder, config=config, **arguments)

    def disturb(self):
        """Runs the experiment with the fault. Returns its output, with that of fault_injector."""
        self.report_path = os.path.join(os.path.dirname(self.folder), "report.json")
        output = self.launch_and_log(self.case.fault)
        if self.case.fault not in CONFIGS:
            self.report = json.loads(read_bytes(self.report_path)) if os.path.exists(self.report_path) else None
        if self.report:
            self.before = self.report["finished"]
            self.log.write(self.report["said"])
            output += self.report["said"]
        return output

    def undo(self):
        filler = os.path.join(self.folder, "filler")
        if os.path.exists(filler):
            os.remove(filler)

    def zero(self):
        """Whether no torque acts after the fault. In real time, the two periods after the last torque are excluded."""
        return self.report.get("motor", "the motor was not watched")

    def in_time(self):
        header, *rows = read_rows(self.folder, "trials.csv")
        slowest_ms = max(float(row[header.index("plan_ms_median")]) for row in rows)
        return "in time" if slowest_ms < 1e3 * REAL_TIME_DT_S else "plans took %g ms" % slowest_ms

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


class AtRest(CaseRun):
    """A case whose fault is in the run folder before the start: a file is damaged, the folder belongs to another
    experiment, or it cannot be written. The folder is a copy of an unfinished experiment. The tested command is the
    experiment or a short recording."""

    def disturb(self):
        """Prepares the run folder with the fault and runs the command. Returns its output."""
        fault, folder, bench = self.case.fault, self.folder, self.bench
        shutil.copytree(bench.begun, folder, dirs_exist_ok=True)
        self.before, self.undo = digests_of_finished(folder), lambda: None
        if fault in UNFINISHED:  # the rest of a bag whose recorder was killed
            content, path = read_bytes(bench.begun, "trial_000", "trial.bag"), os.path.join(folder, UNFINISHED[fault])
            self.half = content[:len(content) // 2]
            write(path, self.half)
            self.undo = lambda: os.path.exists(path) and os.remove(path)
        elif fault == "read-only folder":
            subprocess.run(["mount", "-o", "remount,ro", folder], check=True)
            self.undo = lambda: subprocess.run(["mount", "-o", "remount,rw", folder], check=True)
        elif fault != "other seed":
            name = fault.split()[-1]
            path = os.path.join(folder, name if name in os.listdir(folder) else os.path.join("trial_000", name))
            content = read_bytes(path)
            damage(fault, path)
            self.undo = lambda: write(path, content)
        self.there = digests(folder)
        return self.launch_and_log(fault)

    def launch(self, fault):
        bench, folder = self.bench, self.folder
        if not self.case.expected.startswith("refused"):
            # The logs go into another folder, because this one may be read-only.
            return bench.launch_experiment(bench.reference, folder, seed=SEED + (fault == "other seed"))
        arguments = ["preset:=debug", "num_steps:=10", "bag:=" + os.path.join(folder, BAG)]
        if self.case.fault.endswith("model.ddm"):
            arguments.append("model:=" + os.path.join(folder, "trial_000", "model.ddm"))
        return bench.launch(folder, "record.launch", arguments)

    def bags(self):
        return {name for name in os.listdir(self.folder) if name.startswith(BAG)}

    def refused(self):
        """Whether the launch left no bag."""
        return "acted" if self.bags() - set(self.there) else "refused"

    def acts_when_restored(self):
        """Whether the same launch leaves a bag after the fault is removed."""
        self.undo()
        self.launch_and_log(NO_FAULT)
        return "acts when restored" if self.bags() == {BAG} else "does not act when restored"

    def unchanged(self):
        """Whether the command left all bytes of the run folder unchanged."""
        now = digests(self.folder)
        changed = sorted(name for name in set(self.there) | set(now) if self.there.get(name) != now.get(name))
        return "changed: " + " ".join(changed) if changed else "unchanged"

    def kept(self):
        """Whether the content of an incomplete bag still exists in a file."""
        return "kept" if digest(self.half) in digests(self.folder).values() else "not kept"

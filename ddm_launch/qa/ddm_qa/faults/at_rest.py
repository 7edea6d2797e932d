# Commands on a run folder that is damaged, or is not theirs, or that others use.
# SPDX-License-Identifier: BSD-3-Clause
import os
import shutil
import subprocess
import sys
import time

from ddm_qa.faults.damage import damage
from ddm_qa.faults.finished import Finished, digest, digests
from ddm_qa.run_comparison import files_in, read_bytes

BAG, ACTIVE = "new.bag", "new.bag.active"
WRITTEN_BYTES = 1 << 20
WRITE_AGAIN_AND_AGAIN = """
import sys
from ddm_model.plain_file import write_file
path, letter, size = sys.argv[1:]
for _ in range(200):
    write_file(path, letter * int(size))
"""


def facts(bench, case, folder, log):
    """What was observed, in the words of cases.py. The folder becomes a copy of an experiment that is not finished."""
    shutil.copytree(bench.begun, folder, dirs_exist_ok=True)
    if case.fault.endswith("model.ddm"):
        return record(bench, case, folder, log)
    return {"two writers": write_at_once, "unfinished bag": record, "unfinished trial": run_over}.get(
        case.fault, run_experiment)(bench, case, folder, log)


def run_experiment(bench, case, folder, log):
    """The command must refuse to go on, change nothing, and go on where the fault is taken away."""
    before = Finished.of(folder)
    restore = disturb(bench, case, folder)
    there = digests(folder)
    seed = bench.seed + 1 if case.fault == "other seed" else bench.seed
    output = bench.launch_experiment(bench.reference, folder, seed)  # logs go elsewhere: the folder may be read-only
    log.write(output)
    observed = [bench.verdict(folder)] + bench.words(case, output)
    if "unchanged" in case.expected:
        now = digests(folder)
        changed = sorted(name for name in set(there) | set(now) if there.get(name) != now.get(name))
        observed.append("changed: " + " ".join(changed) if changed else "unchanged")
    restore()
    return observed + bench.resume(case, folder, before, log)


def disturb(bench, case, folder):
    """Returns a function that takes the fault away."""
    if case.fault == "other seed":
        return lambda: None
    if case.fault == "unfinished bag":
        path = os.path.join(folder, ACTIVE)
        write(path, unfinished(bench))
        return lambda: os.path.exists(path) and os.remove(path)
    if case.fault == "read-only folder":
        subprocess.run(["mount", "-o", "remount,ro", folder], check=True)
        return lambda: subprocess.run(["mount", "-o", "remount,rw", folder], check=True)
    path, content = damage(case.fault, folder)
    return lambda: write(path, content)


def write(path, content):
    with open(path, "wb") as stream:
        stream.write(content)


def unfinished(bench):
    """What is left of a bag whose recorder was killed."""
    content = read_bytes(bench.begun, "trial_000", "trial.bag")
    return content[:len(content) // 2]


def record(bench, case, folder, log):
    """The launch of a short trial that cannot use its model, or would write over an unfinished bag, must leave no bag;
    with the fault taken away, the same launch leaves one."""
    arguments = ["preset:=debug", "num_steps:=10", "bag:=" + os.path.join(folder, BAG)]
    if case.fault != "unfinished bag":
        arguments.append("model:=" + os.path.join(folder, "trial_000", "model.ddm"))

    def bags():
        return [name for name in (BAG, ACTIVE) if name in os.listdir(folder)]

    def launch():
        """Its output, and the bags that are there then, complete or not."""
        output = bench.launch(folder, "record.launch", arguments)
        log.write(output)
        return output, bags()

    restore = disturb(bench, case, folder)
    before = bags()
    output, after = launch()
    observed = ["refused" if after == before else "acted"] + bench.words(case, output)
    if before:
        kept = after == before and read_bytes(folder, ACTIVE) == unfinished(bench)
        observed.append("kept" if kept else "not kept")
    restore()
    return observed + ["acts when restored" if launch()[1] == [BAG] else "does not act when restored"]


def run_over(bench, case, folder, log):
    """An experiment runs a trial again whose bag was not completed, and keeps that bag."""
    os.makedirs(os.path.join(folder, "trial_001"))
    write(os.path.join(folder, "trial_001", "trial.bag.active"), unfinished(bench))
    log.write(bench.launch_experiment(folder, folder))
    kept = digest(unfinished(bench)) in digests(folder).values()
    return [bench.verdict(folder), "kept" if kept else "not kept", bench.compared(folder)]


def write_at_once(_, __, folder, log):
    """Two programs write one file again and again: at any time it must be that of the one or of the other."""
    path = os.path.join(folder, "shared.txt")
    wholes = [letter.encode() * WRITTEN_BYTES for letter in "ab"]
    there = files_in(folder)
    running = [subprocess.Popen([sys.executable, "-c", WRITE_AGAIN_AND_AGAIN, path, letter, str(WRITTEN_BYTES)],
                                stdin=subprocess.DEVNULL, stdout=log, stderr=subprocess.STDOUT) for letter in "ab"]
    mixed = 0
    while any(process.poll() is None for process in running):
        if os.path.exists(path):
            mixed += read_bytes(path) not in wholes
        time.sleep(0.001)
    left = sorted(set(files_in(folder)) - set(there) - {"shared.txt"})
    if left:
        return ["left: " + " ".join(left)]
    if any(process.returncode != 0 for process in running):
        return ["failed"]
    return ["mixed" if mixed or read_bytes(path) not in wholes else "one is whole"]

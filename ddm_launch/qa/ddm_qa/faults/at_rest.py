# Commands on a run folder that is damaged, or is not theirs, or that others use.
# SPDX-License-Identifier: BSD-3-Clause
import os
import shutil
import struct
import subprocess

from ddm_qa.run_comparison import Finished, digest, digests, read_bytes

BAG, ACTIVE = "new.bag", "new.bag.active"
# Kinds of records in a bag, by the field `op` of their headers.
RECORDS = {"header": 3, "index": 4, "chunk": 5, "chunk_info": 6, "connection": 7}
VERSION_LINE = b"#ROSBAG V2.0\n"


def facts(bench, case, folder, log):
    """What was observed, in the words of cases.py. The folder becomes a copy of an experiment that is not finished."""
    shutil.copytree(bench.begun, folder, dirs_exist_ok=True)
    if case.fault.endswith("model.ddm"):
        return record(bench, case, folder, log)
    return {"unfinished bag": record, "unfinished trial": run_over}.get(case.fault, run_experiment)(bench, case, folder, log)


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


def find_record(data, name):
    """(begin, end) of the first record of a kind in a bag."""
    if name == "version":
        return 0, len(VERSION_LINE)
    begin = len(VERSION_LINE)
    while begin < len(data):
        header_size, = struct.unpack_from("<I", data, begin)
        header = data[begin + 4:begin + 4 + header_size]
        data_size, = struct.unpack_from("<I", data, begin + 4 + header_size)
        end = begin + 8 + header_size + data_size
        if b"op=" + bytes([RECORDS[name]]) in header:
            return begin, end
        begin = end
    raise ValueError("the bag has no record " + name)


def damage(fault, folder):
    """Does what the fault says, `cut|flip|remove [PLACE of] FILE`. Returns the path of the file and what it held."""
    verb, *place, name = fault.split()
    path = os.path.join(folder, name if name in os.listdir(folder) else os.path.join("trial_000", name))
    with open(path, "rb") as stream:
        data = stream.read()
    begin, end = 0, len(data)
    if place:
        digit = data.rfind(b",") - 1  # the last one of a table: its last column is text
        places = {"head": (0, 8), "end": (end - 16, end), "digit": (digit, digit + 1)}
        begin, end = places.get(place[0]) or find_record(data, place[0])
    middle = (begin + end) // 2
    if verb == "remove":
        os.remove(path)
        return path, data
    bit = 0x01 if place == ["digit", "of"] else 0x80  # which makes another digit of one
    after = data[:middle] if verb == "cut" else data[:middle] + bytes([data[middle] ^ bit]) + data[middle + 1:]
    with open(path, "wb") as stream:
        stream.write(after)
    return path, data

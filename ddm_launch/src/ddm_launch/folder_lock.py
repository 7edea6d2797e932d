# A folder for one process at a time.
# SPDX-License-Identifier: BSD-3-Clause
import contextlib
import os
import platform
import time

from ddm_launch.command import Failure, held_back

OPENING_LIMIT_S = 10.0  # others take milliseconds from step 1 to 2


def first_line(path):
    with contextlib.suppress(OSError), open(path, errors="replace") as stream:
        return stream.readline().rstrip("\n")
    return ""


def start_of(pid):
    """When a process was started, in ticks since the machine was: numbers of processes come again. "ended" for one that has
    ended and waits for its parent; empty if that is not known."""
    fields = first_line("/proc/%s/stat" % pid).rpartition(")")[2].split()  # from field 3 of proc(5) on
    return "" if len(fields) < 20 else "ended" if fields[0] in "ZX" else fields[19]


def this_process():
    boot = first_line("/proc/sys/kernel/random/boot_id")
    return {"boot": boot, "host": platform.node(), "machine": first_line("/etc/machine-id") or boot,
            "namespace": os.readlink("/proc/self/ns/pid"), "pid": str(os.getpid()), "start": start_of(os.getpid())}


def text_of(owner):
    return "".join("%s: %s\n" % entry for entry in sorted(owner.items()))


def read(path):
    with contextlib.suppress(OSError), open(path, errors="replace") as stream:
        return stream.read()
    return ""


def parse_owner(text):
    """None if the text does not name a process."""
    owner = dict(line.split(": ", 1) for line in text.split("\n") if ": " in line)
    is_complete = {"boot", "host", "machine", "namespace", "pid", "start"} <= set(owner)
    return owner if is_complete and owner["pid"].isdigit() and int(owner["pid"]) > 0 else None


def is_on_this_machine(owner, own):
    return owner["host"] == own["host"] and owner["machine"] == own["machine"]


def has_ended(owner, own):
    """Whether it is certain that a process has ended. That of another container cannot be seen."""
    if not is_on_this_machine(owner, own):
        return False
    if owner["boot"] != own["boot"]:
        return True
    if owner["namespace"] != own["namespace"]:
        return False
    start = start_of(owner["pid"])
    if start and owner["start"]:
        return start != owner["start"]
    try:
        os.kill(int(owner["pid"]), 0)
    except ProcessLookupError:
        return True
    except OSError:  # it is that of another user, whose processes are hidden here
        pass
    return False


class FolderLock:
    """While it is held, no other process gets the folder. How, and why that is safe, is told in
    ddm_msgs/common/include/ddm_common/folder_lock.h, which does the same in C++."""

    def __init__(self, folder):
        """Raises Failure if another process has the folder, OSError if the files cannot be written."""
        self._path, self._owner = os.path.join(os.path.realpath(folder), ".lock"), this_process()
        created = self._path + ".new"
        with held_back():  # a signal between the steps would leave .lock.new behind
            self._create(folder, created)
            try:
                if os.path.lexists(self._path):
                    other = parse_owner(read(self._path))
                    if other is None or not has_ended(other, self._owner):
                        self._refuse(folder, other)
                os.rename(created, self._path)
            except BaseException:
                os.remove(created)
                raise

    def _create(self, folder, path):
        """Step 1: creates .lock.new."""
        end = time.monotonic() + OPENING_LIMIT_S
        while True:
            try:
                stream = open(path, "x")
                break
            except FileExistsError:
                if time.monotonic() > end:
                    raise Failure("another process has been opening the folder %s for %d s: if none is, delete %s"
                                  % (folder, OPENING_LIMIT_S, path)) from None
                time.sleep(0.02)
        try:
            with stream:
                stream.write(text_of(self._owner))
                stream.flush()
                os.fsync(stream.fileno())
        except OSError:
            os.remove(path)
            raise

    def _refuse(self, folder, other):
        if other is None:
            raise Failure("another process may be running in the folder %s, but its lock does not name one: if none is, "
                          "delete %s" % (folder, self._path))
        here = is_on_this_machine(other, self._owner) and other["namespace"] == self._owner["namespace"]
        raise Failure("another process is running in the folder %s: process %s on %s%s. Wait for it, or use another folder%s"
                      % (folder, other["pid"], "this machine, " if here else "", other["host"],
                         "" if here else ". If you are sure that this process has ended, delete %s" % self._path))

    def release(self):
        if read(self._path) == text_of(self._owner):  # unless a person has deleted it
            os.remove(self._path)

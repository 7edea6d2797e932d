# A folder for one process at a time.
# SPDX-License-Identifier: BSD-3-Clause
import contextlib
import os
import platform
import time

from ddm_launch.command import Failure, held_back

OPENING_LIMIT_S = 10.0  # others take milliseconds from step 1 to 2


def read(path):
    with contextlib.suppress(OSError), open(path, errors="replace") as stream:
        return stream.read()
    return ""


def start_of(pid):
    """When a process was started, in ticks since the machine was: numbers of processes come again. "ended" for one that has
    ended and waits for its parent; empty if that is not known."""
    fields = read("/proc/%s/stat" % pid).rpartition(")")[2].split()  # from field 3 of proc(5) on
    return "" if len(fields) < 20 else "ended" if fields[0] in "ZX" else fields[19]


def this_process():
    boot = read("/proc/sys/kernel/random/boot_id").strip()
    return {"boot": boot, "host": platform.node(), "machine": read("/etc/machine-id").strip() or boot,
            "namespace": os.readlink("/proc/self/ns/pid"), "pid": str(os.getpid()), "start": start_of(os.getpid())}


def text_of(owner):
    return "".join("%s: %s\n" % entry for entry in sorted(owner.items()))


def is_here(owner, own):
    """Whether a process ran where this one can see it: on this machine, and not in another container."""
    return all(owner[key] == own[key] for key in ("host", "machine", "namespace"))


def has_ended(owner, own):
    """Whether it is certain that a process has ended."""
    if owner["boot"] != own["boot"]:
        return owner["host"] == own["host"] and owner["machine"] == own["machine"]
    if not is_here(owner, own):
        return False
    start = start_of(owner["pid"])
    if start and owner["start"]:
        return start != owner["start"]
    try:
        os.kill(int(owner["pid"]), 0)
    except ProcessLookupError:
        return True
    except OSError:  # a process of another user, whose processes are hidden here
        pass
    return False


class FolderLock:
    """While it is held, no other process gets the folder. The header ddm_common/folder_lock.h explains the files and why
    the steps are safe; it does the same in C++."""

    def __init__(self, folder):
        """Raises Failure if another process has the folder, OSError if the files cannot be written."""
        self._path, self._own = os.path.join(os.path.realpath(folder), ".lock"), this_process()
        created = self._path + ".new"
        with held_back():  # a signal between the steps would leave .lock.new behind
            stream = self._create(folder, created)
            try:
                with stream:
                    stream.write(text_of(self._own))
                    stream.flush()
                    os.fsync(stream.fileno())
                if os.path.lexists(self._path):
                    self._require_ended(folder)
                os.rename(created, self._path)
            except BaseException:
                os.remove(created)
                raise

    @staticmethod
    def _create(folder, path):
        end = time.monotonic() + OPENING_LIMIT_S
        while True:
            try:
                return open(path, "x")
            except FileExistsError:
                if time.monotonic() > end:
                    raise Failure("another process has been opening the folder %s for %d s: if none is, delete %s"
                                  % (folder, OPENING_LIMIT_S, path)) from None
                time.sleep(0.02)

    def _require_ended(self, folder):
        owner = dict(line.split(": ", 1) for line in read(self._path).split("\n") if ": " in line)
        if not set(self._own) <= set(owner) or not owner["pid"].isdigit() or int(owner["pid"]) < 1:
            raise Failure("another process may be running in the folder %s, but its lock does not name one: if none is, "
                          "delete %s" % (folder, self._path))
        if has_ended(owner, self._own):
            return
        here = is_here(owner, self._own)
        raise Failure("another process is running in the folder %s: process %s on %s%s. Wait for it, or use another folder%s"
                      % (folder, owner["pid"], "this machine, " if here else "", owner["host"],
                         "" if here else ". If you are sure that this process has ended, delete %s" % self._path))

    def release(self):
        if read(self._path) == text_of(self._own):  # unless a person has deleted it
            os.remove(self._path)

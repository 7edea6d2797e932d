# The processes behind the nodes of a master on this machine: memory and open files, from /proc.
# SPDX-License-Identifier: BSD-3-Clause
import os
import re
import xmlrpc.client


def pid_of(master, node):
    """Process of a node, or of `master` itself. master: a rosgraph.Master."""
    if node == "master":
        return master.getPid()
    return xmlrpc.client.ServerProxy(master.lookupNode("/" + node.lstrip("/"))).getPid(master.caller_id)[2]


def memory_kb(pid, field):
    """A field of /proc/PID/status, such as VmRSS, the resident memory, or VmHWM, its peak [kB]."""
    with open("/proc/%d/status" % pid) as stream:
        return int(re.search(field + r":\s+(\d+) kB", stream.read()).group(1))


def num_open_files(pid):
    return len(os.listdir("/proc/%d/fd" % pid))
